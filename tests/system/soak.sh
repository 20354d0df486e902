#!/usr/bin/env bash
# tests/system/soak.sh [--seconds N] [--seed N] [--keep DIR]: runs the daemon on two simulated cameras for an hour, with
# faults between them (tests/system/soak.py), and compares each VALID velocity with the truth at its utime; it records,
# and its metrics are read each second. Prints each fault, and a summary; exits with 0 only if no VALID message was above an alert limit and at most 1 in 10,000 above its bound, no
# message is missing, memory, threads and descriptors have not grown, and the daemon did not end.
# Same seed, same faults. The first run renders the drive (some minutes).
set -euo pipefail
case ${1-} in -h | --help) sed -n '2,/^[^#]/{s/^# \{0,1\}//p;}' "$0" && exit ;; esac
cd "$(dirname "$0")/../.."
export CARTVO_BUILD=${CARTVO_BUILD:-$PWD/build/release}
for program in "$CARTVO_BUILD/daemon/cartvod" "$CARTVO_BUILD/tools/cartvo/cartvo"; do
  [ -x "$program" ] || { echo "soak.sh: $program is missing: run tools/build first" >&2; exit 2; }
done
exec tools/in_network_namespace unshare --mount python3 tests/system/soak.py "$@"
