#!/usr/bin/env bash
# usage: reference_page.sh [--check] STRANDCASTD STRANDCAST
# Writes the options that the two programs print (--help-markdown) between the two marks of docs/reference.md.
# --check changes nothing; the exit status is 1 where the page would change.
set -euo pipefail
check=0
[ "${1:-}" != --check ] || { check=1; shift; }
[ $# -eq 2 ] || { sed -n '2,4s/^# //p' "$0"; exit 2; }
page=$(dirname "$0")/../../docs/reference.md
first='<!-- Options: ./dev reference writes what follows. -->' last='<!-- End of the options. -->'
for mark in "$first" "$last"; do
  grep -qxF -- "$mark" "$page" || { echo "docs/reference.md has no line '$mark'" >&2; exit 1; }
done
made=$(mktemp)
trap 'rm -f "$made"' EXIT
{
  sed "\\|^$first\$|q" "$page"
  echo
  "$1" --help-markdown
  "$2" --help-markdown
  sed -n "\\|^$last\$|,\$p" "$page"
} >"$made"
if [ $check = 0 ]; then
  cat "$made" >"$page"
elif ! diff -u "$page" "$made"; then
  echo "docs/reference.md differs from the options of the programs: run ./dev reference" >&2
  exit 1
fi
