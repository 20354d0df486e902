#!/bin/sh
# in_network_namespace.sh COMMAND [ARG ...]: runs a test in a network namespace with only the loopback device, so that it
# neither depends on the routes of this computer nor sends anything through them. If namespaces are not permitted, it
# prints the requirement and skips the test (exit 77); with CARTVO_REQUIRE_DATA=1 (CI) it fails.
set -u
tool=$(dirname "$0")/../../tools/in_network_namespace
if ! reason=$("$tool" true 2>&1); then
  echo "skipped: no network namespace of its own: $reason"
  echo "needed: root, or 'sysctl kernel.unprivileged_userns_clone=1' and no AppArmor restriction of user namespaces"
  [ "${CARTVO_REQUIRE_DATA:-0}" = 1 ] && exit 1
  exit 77
fi
exec "$tool" "$@"
