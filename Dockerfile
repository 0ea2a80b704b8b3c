# The web demo: the dashboard for anyone who has its address.
#
#   docker build -t bogie-hunting .
#   docker run --read-only --cap-drop ALL -p 5006:5006 bogie-hunting

FROM python:3.12-slim-bookworm AS builder
ENV PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore
WORKDIR /build

# The environment of the demo has no pip of its own.
RUN python -m venv --without-pip /opt/demo && python -m venv /opt/build
COPY requirements.lock deploy/build.lock ./
RUN pip --python /opt/demo/bin/python install --no-compile --only-binary :all: \
        --require-hashes -r requirements.lock \
    && /opt/build/bin/pip install --only-binary :all: --require-hashes -r build.lock

COPY pyproject.toml README.md LICENSE ./
COPY model model
COPY app app
RUN /opt/build/bin/pip wheel --no-deps --no-build-isolation --wheel-dir dist . \
    && pip --python /opt/demo/bin/python install --no-compile --no-deps dist/*.whl

# What only the packages' own developers need, goes; what every start would compile, is compiled.
COPY deploy/demo /opt/demo/lib/python3.12/site-packages/demo
RUN find /opt/demo/lib -type d \( -name tests -o -name examples \) -prune -exec rm -r {} + \
    && find /opt/demo/lib -name '*.map' -delete \
    && python -m compileall -q --invalidation-mode unchecked-hash /opt/demo/lib

FROM python:3.12-slim-bookworm
ARG VERSION=0.1.0
ARG REVISION=unknown
LABEL org.opencontainers.image.title="bogie-hunting" \
      org.opencontainers.image.description="Critical speeds and limit cycles of a railway bogie, live while every parameter moves" \
      org.opencontainers.image.version="$VERSION" \
      org.opencontainers.image.revision="$REVISION" \
      org.opencontainers.image.licenses="BSD-3-Clause" \
      org.opencontainers.image.base.name="python:3.12-slim-bookworm"

RUN python -m pip uninstall --quiet --yes --root-user-action=ignore pip
COPY --from=builder /opt/demo /opt/demo

# One process serves one core: more threads of the linear algebra only get in each other's way.
ENV PATH=/opt/demo/bin:$PATH \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1 \
    HOME=/tmp \
    OPENBLAS_NUM_THREADS=1 \
    PORT=5006
WORKDIR /
USER 10001:10001
EXPOSE 5006
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=10s --timeout=5s --start-period=30s --retries=3 \
    CMD ["python", "-m", "demo.health"]
CMD ["python", "-m", "demo"]
