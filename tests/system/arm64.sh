#!/usr/bin/env bash
# tests/system/arm64.sh [FOLDER]: checks that the odometry runs on 64-bit ARM, where its vectors become NEON, with the same
# results as on this machine. Builds vo_core and its tests with Debian's cross compiler against Debian's arm64 packages, which
# it downloads into FOLDER (default: /var/tmp/cartvo-arm64) without installing them, and runs them in QEMU. Run by hand.
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=$(realpath -m "${1:-/var/tmp/cartvo-arm64}")
apt=$folder/apt
build=$folder/build
digest=build/release/tests/vo_core/odometry_digest
export CARTVO_ARM64_ROOT=$folder/root
# Libraries that an installation would have linked to by update-alternatives.
export CARTVO_ARM64_CHOSEN=/usr/lib/aarch64-linux-gnu/blas:/usr/lib/aarch64-linux-gnu/lapack
run=(qemu-aarch64 -L "$CARTVO_ARM64_ROOT" -E "LD_LIBRARY_PATH=$CARTVO_ARM64_CHOSEN")
CARTVO_ARM64_RUN=$(IFS=';' && echo "${run[*]}")
export CARTVO_ARM64_RUN

for program in aarch64-linux-gnu-g++-12 qemu-aarch64; do
  command -v $program >/dev/null || {
    echo "arm64.sh: needs $program (apt-get install g++-12-aarch64-linux-gnu qemu-user)" >&2
    exit 1
  }
done

[ -x $digest ] || {
  echo "arm64.sh: needs the release build of this machine for the comparison (run tools/build)" >&2
  exit 1
}

fetch_packages() {
  mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial" "$CARTVO_ARM64_ROOT"
  : >"$apt/status"
  cat >"$apt/apt.conf" <<END
APT::Architecture "arm64";
APT::Architectures { "arm64"; };
APT::Install-Recommends "false";
Dir::State "$apt";
Dir::State::status "$apt/status";
Dir::Cache "$apt/cache";
Debug::NoLocking "true";
END
  local libraries
  mapfile -t libraries < <(grep -E '^(lib.*|nlohmann-json3)-dev$' tools/packages.txt)
  APT_CONFIG=$apt/apt.conf apt-get update
  APT_CONFIG=$apt/apt.conf apt-get install -y --download-only libc6-dev libstdc++-12-dev "${libraries[@]}"
  for package in "$apt"/cache/archives/*.deb; do
    dpkg-deb -x "$package" "$CARTVO_ARM64_ROOT"
  done
  touch "$folder/fetched"
}

[ -e "$folder/fetched" ] || fetch_packages
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCARTVO_PYTHON=OFF --toolchain "$PWD/tests/system/arm64.cmake"
cmake --build "$build" --target odometry_digest cartvo_vo_core_tests

ctest --test-dir "$build" -j "$(nproc)" --output-on-failure -R '^vo_core\.' -E same_on_each_processor
tests/vo_core/same_on_each_processor.py "$digest" "${run[@]}" "$build/tests/vo_core/odometry_digest"
