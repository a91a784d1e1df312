# One static binary, in an image that holds nothing else: docker build -t takt .

FROM rust:1.95-bookworm AS build
WORKDIR /src

# The dependencies by themselves, with the crates as empty shells: this layer is built again only when a manifest or
# the lock file changes.
COPY Cargo.toml Cargo.lock ./
COPY checker/Cargo.toml checker/
COPY cli/Cargo.toml cli/
COPY client/Cargo.toml client/
COPY motion/Cargo.toml motion/
COPY proto/Cargo.toml proto/
COPY server/Cargo.toml server/
COPY tests/Cargo.toml tests/
COPY deploy/build-static deploy/
RUN deploy/build-static --dependencies

COPY . .
RUN deploy/build-static

# What the final image holds: the binary, and a directory for the store that its user may write to.
RUN install -D target/static/takt /image/usr/local/bin/takt && mkdir -p /image/var/lib/takt

FROM scratch
COPY --from=build /image/usr /usr
COPY --from=build --chown=65532:65532 /image/var/lib/takt /var/lib/takt
USER 65532:65532
ENV TAKT_LISTEN=0.0.0.0:7171 \
    TAKT_STORE=/var/lib/takt/robots.db \
    TAKT_LOG_FORMAT=json
EXPOSE 7171
VOLUME /var/lib/takt
ENTRYPOINT ["/usr/local/bin/takt"]
CMD ["serve"]
HEALTHCHECK --interval=10s --timeout=3s --start-period=10s --retries=3 CMD ["/usr/local/bin/takt", "health"]
