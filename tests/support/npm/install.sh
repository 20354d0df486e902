#!/usr/bin/env bash
# install.sh FOLDER [SCRIPT ...]: installs the packages of package-lock.json into FOLDER, once, and copies the scripts that use
# them beside them. Fails with the reason if Node.js or npm is missing or the registry cannot be reached.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
folder=$1
shift
mkdir -p "$folder"
exec 9>"$folder/lock"
flock 9  # tests run side by side
for program in node npm; do
  command -v $program >/dev/null || { echo "$program is not installed: what needs packages of npm is not tried"; exit 1; }
done
if ! cmp -s "$here/package-lock.json" "$folder/package-lock.json" || [ ! -f "$folder/installed" ]; then
  rm -f "$folder/installed"
  cp "$here/package.json" "$here/package-lock.json" "$folder"
  (cd "$folder" && timeout 120 npm ci --ignore-scripts --fetch-retries=1 --no-audit --no-fund >npm.log 2>&1 </dev/null) ||
    { echo "npm cannot install packages, see $folder/npm.log: what needs them is not tried"; exit 1; }
  touch "$folder/installed"
fi
[ $# -eq 0 ] || cp "$@" "$folder"
