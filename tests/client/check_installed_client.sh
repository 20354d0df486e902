#!/bin/sh
# check_installed_client.sh BUILD-FOLDER: installs the component "client" into an empty folder and builds against it: a C++17
# program by find_package and by pkg-config, and the example in C as its first comment says.
set -eu
build=$1
messages=$(cd "$(dirname "$0")/../../daemon/messages" && pwd)
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
cmake --install "$build" --component client --prefix "$root" >"$root/install.log" 2>&1 || { cat "$root/install.log"; exit 1; }

mkdir "$root/user"
cat >"$root/user/main.cpp" <<'END'
#include <cartvo/client.hpp>
#include <cartvo/health_t.hpp>
int main() {
  lcm::LCM lcm("memq://");
  cartvo::client::OdometryClient odometry(lcm);
  odometry.update(0);
  return odometry.input().state == cartvo::client::InputState::waiting ? 0 : 1;
}
END
cat >"$root/user/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.18)
project(user CXX)
set(CMAKE_CXX_STANDARD 17)
find_package(cartvo_client 0.1 REQUIRED)
add_executable(user main.cpp)
target_link_libraries(user PRIVATE cartvo::cartvo_client)
END
# The sanitizers of this build, which the library then needs too.
flags=$(sed -n 's/^CARTVO_SANITIZE:STRING=\(..*\)/-fsanitize=\1/p' "$build/CMakeCache.txt")
if ! { cmake -S "$root/user" -B "$root/user/build" -DCMAKE_PREFIX_PATH="$root" -DCMAKE_CXX_FLAGS="$flags" &&
  cmake --build "$root/user/build"; } >"$root/cmake.log" 2>&1; then
  cat "$root/cmake.log"
  exit 1
fi
"$root/user/build/user"

pc=$(find "$root" -name cartvo_client.pc)
# shellcheck disable=SC2046,SC2086  # options, one per word
g++ -std=c++17 -Wall -Werror $flags "$root/user/main.cpp" -o "$root/user/by_pkg_config" \
  $(PKG_CONFIG_PATH=$(dirname "$pc") pkg-config --cflags --libs cartvo_client)
"$root/user/by_pkg_config"

cd "$root/user"
lcm-gen --c "$messages/odometry_t.lcm"
cc -std=c11 -D_POSIX_C_SOURCE=200809L -Wall -Werror -I. "$(find "$root" -name controller.c)" cartvo_odometry_t.c -o controller -llcm -lm
echo "client.installed: built by find_package, by pkg-config and in C"
