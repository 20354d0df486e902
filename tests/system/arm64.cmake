# Toolchain for tests/system/arm64.sh, which sets these variables: Debian's cross compiler and the Debian packages in
# $CARTVO_ARM64_ROOT.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_SYSROOT $ENV{CARTVO_ARM64_ROOT})
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++-12)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc-12)

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${CMAKE_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)

string(REPLACE ":" ":${CMAKE_SYSROOT}" chosen ":$ENV{CARTVO_ARM64_CHOSEN}")
string(SUBSTRING "${chosen}" 1 -1 chosen)
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,-rpath-link,${chosen}")
set(CMAKE_CROSSCOMPILING_EMULATOR $ENV{CARTVO_ARM64_RUN})
