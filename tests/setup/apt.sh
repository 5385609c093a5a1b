#!/bin/sh
# Installs the named Debian packages; asks for root only when some are missing.
set -eu
export DEBIAN_FRONTEND=noninteractive TMPDIR="${TMPDIR:-/var/tmp}"
as_root=""
if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || { echo "these Debian packages are missing, ask an administrator for them: $*" >&2; exit 1; }
    as_root="sudo -E"
fi
$as_root apt-get update -qq
$as_root apt-get install -y -qq --no-install-recommends "$@"
