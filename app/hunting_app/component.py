"""What is drawn by JavaScript of our own."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from panel.custom import JSComponent

if TYPE_CHECKING:
    from bokeh.document import Document


class Component(JSComponent):
    """A component whose module is plain JavaScript.

    Panel takes a module for TypeScript and lets the browser translate it, once for each component
    on the page: a tenth of the time the page takes to open. A bundle is taken as it is.
    """

    __abstract = True

    def _get_properties(self, doc: Document | None) -> dict[str, Any]:
        properties: dict[str, Any] = super()._get_properties(doc)
        digest = hashlib.sha256(properties["esm"].encode()).hexdigest()
        return properties | {"bundle": digest}
