"""How the model is built: what it imports, in which order, and who knows which names."""

from __future__ import annotations

import ast
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import hunting
from hunting import RECONSTRUCTED, Parameters, bogie

PACKAGE = Path(hunting.__file__).parent
MODULES = {path.stem: ast.parse(path.read_text(encoding="utf-8")) for path in PACKAGE.glob("*.py")}


def imported(tree):
    """Return the dotted names of the modules that a module imports, anywhere in it."""
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            names.add(node.module)
    return names


def test_the_model_imports_numpy_scipy_and_the_standard_library_alone():
    allowed = {"numpy", "scipy", "hunting"} | sys.stdlib_module_names
    foreign = {
        name: extra
        for name, tree in MODULES.items()
        if (extra := {module.split(".")[0] for module in imported(tree)} - allowed)
    }
    assert not foreign


def test_imports_run_one_way():
    graph = {
        name: {m.removeprefix("hunting.") for m in imported(tree) if m.startswith("hunting.")}
        for name, tree in MODULES.items()
        if name != "__init__"
    }
    assert not any("__init__" in names or "hunting" in names for names in graph.values())
    order = list(TopologicalSorter(graph).static_order())  # raises on a cycle
    assert order.index("elements") < order.index("lure") < order.index("vehicles")
    assert order.index("stability") < order.index("bogoliubov") < order.index("critical_speeds")


def test_no_numerical_method_knows_a_vehicle():
    for name in set(MODULES) - {"__init__", "vehicles", "study"}:
        assert "hunting.vehicles" not in imported(MODULES[name]), name


def test_only_the_vehicles_know_the_parameters_by_name():
    fields = {f.name for f in Parameters.fields()}
    for name in set(MODULES) - {"__init__", "parameters", "vehicles", "study"}:
        read = {
            node.attr
            for node in ast.walk(MODULES[name])
            if isinstance(node, ast.Attribute)
            and not (isinstance(node.value, ast.Name) and node.value.id == "self")
        }
        assert not read & fields, f"{name}.py reads {read & fields}"


def test_only_the_vehicles_know_the_states():
    symbols = {state.symbol for state in bogie(RECONSTRUCTED).states}
    for name in set(MODULES) - {"vehicles"}:
        texts = {
            node.value
            for node in ast.walk(MODULES[name])
            if isinstance(node, ast.Constant) and isinstance(node.value, str)
        }
        assert not texts & symbols, name


def test_every_public_name_is_there_and_documented():
    assert len(set(hunting.__all__)) == len(hunting.__all__)
    for name in hunting.__all__:
        assert getattr(hunting, name).__doc__, name
