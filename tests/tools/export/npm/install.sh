#!/usr/bin/env bash
# install.sh FOLDER: installs the packages of package-lock.json into FOLDER, once, and the reader beside them. Fails with
# the reason if Node.js or npm is missing or the registry cannot be reached.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
mkdir -p "$1"
exec 9>"$1/lock"
flock 9  # tests run side by side
for program in node npm; do
  command -v $program >/dev/null || { echo "$program is not installed: other projects' readers are not tried"; exit 1; }
done
if ! cmp -s "$here/package-lock.json" "$1/package-lock.json" || [ ! -f "$1/installed" ]; then
  rm -f "$1/installed"
  cp "$here/package.json" "$here/package-lock.json" "$1"
  (cd "$1" && timeout 120 npm ci --ignore-scripts --fetch-retries=1 --no-audit --no-fund >npm.log 2>&1 </dev/null) ||
    { echo "npm cannot install the readers, see $1/npm.log: other projects' readers are not tried"; exit 1; }
  touch "$1/installed"
fi
cp "$here/read_mcap.mjs" "$1"
