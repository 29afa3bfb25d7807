# syntax=docker/dockerfile:1
FROM python:3.13.16-slim-bookworm AS build
WORKDIR /src
COPY pyproject.toml README.md LICENSE ./
COPY cleave cleave
COPY segcore segcore
COPY worker worker
COPY service service
RUN python -m venv /opt/cleave && /opt/cleave/bin/pip install --no-cache-dir ".[cloud,draco,mcp,print,robot,usd]"
# The kernels are compiled here, so that containers do not compile them.
ENV NUMBA_CACHE_DIR=/opt/cleave/kernels \
    NUMBA_CPU_NAME=generic
RUN /opt/cleave/bin/python -P -m segcore.kernels

FROM python:3.13.16-slim-bookworm
RUN groupadd --system --gid 10001 cleave \
    && useradd --system --uid 10001 --gid cleave --no-create-home cleave \
    && install -d -m 700 -o cleave -g cleave /data
COPY --from=build /opt/cleave /opt/cleave
ENV PATH=/opt/cleave/bin:$PATH \
    NUMBA_CACHE_DIR=/opt/cleave/kernels \
    NUMBA_CPU_NAME=generic \
    CLEAVE_DATA_DIR=/data \
    PYTHONUNBUFFERED=1
USER 10001:10001
VOLUME /data
EXPOSE 8000
STOPSIGNAL SIGTERM
# A container of workers serves no HTTP: docker-compose.yml replaces its health check.
HEALTHCHECK --interval=10s --timeout=5s --start-period=60s \
    CMD ["python", "-c", "import urllib.request; urllib.request.urlopen('http://127.0.0.1:8000/healthz', timeout=4)"]
ENTRYPOINT ["cleave"]
CMD ["serve", "--host", "0.0.0.0"]
