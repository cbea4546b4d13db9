# Builds osteomill on Debian 12 and runs every test of the release preset; the image contains the program.
#   docker build -t osteomill .
#   docker run --rm -v ~/scans:/scans -v "$PWD:/out" -w /out osteomill compare /scans/tooth --out tooth
FROM debian:12 AS build
WORKDIR /osteomill
COPY scripts/install-packages scripts/debian-packages.txt scripts/
RUN scripts/install-packages
COPY . .
RUN cmake --preset release -DCMAKE_COMPILE_WARNING_AS_ERROR=ON && cmake --build --preset release
RUN ctest --preset release --parallel "$(nproc)"
RUN cmake --install build/release --prefix /opt/osteomill

FROM build
ENV PATH=/opt/osteomill/bin:$PATH
ENTRYPOINT ["osteomill"]
CMD ["--help"]
