#!/bin/sh
# in_network_namespace.sh COMMAND [ARG ...]: runs a test where the network is nothing but loopback, so that it neither
# depends on this host's routes nor sends anything through them. Where namespaces are not permitted the test is skipped
# (exit 77) with what is missing; with CARTVO_REQUIRE_DATA=1 (CI) that is a failure.
set -u
tool=$(dirname "$0")/../../tools/in_network_namespace
if ! reason=$("$tool" true 2>&1); then
  echo "skipped: no network namespace of its own: $reason"
  echo "needed: root, or 'sysctl kernel.unprivileged_userns_clone=1' and no AppArmor restriction of user namespaces"
  [ "${CARTVO_REQUIRE_DATA:-0}" = 1 ] && exit 1
  exit 77
fi
exec "$tool" "$@"
