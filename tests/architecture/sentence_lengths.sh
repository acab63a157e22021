#!/usr/bin/env bash
# usage: sentence_lengths.sh [--limit] FILE.md...
# Prints how many words the sentences of Markdown files have: count, median, 90th percentile, longest.
# With --limit the exit status is 1 where a median is above 18 or a 90th percentile above 32.
# Sentences end at . ! or ? before white space, and at the end of a paragraph or list item.
# Code blocks, tables, headings and pictures do not count.
set -euo pipefail
limit=0
[ "${1:-}" != --limit ] || { limit=1; shift; }
[ $# -gt 0 ] || { sed -n '2,6s/^# //p' "$0"; exit 2; }
status=0
printf '%-28s %9s %7s %5s %8s\n' file sentences median p90 longest
for file in "$@"; do
  lengths=$(awk '
    function end() { if (words > 0) print words; words = 0 }
    /^ *```/ { end(); in_code = !in_code; next }
    in_code || /^ *\|/ || /^#/ || /^ *!\[/ || /^ *</ { end(); next }
    /^ *$/ { end(); next }
    {
      if (sub(/^ *([-*]|[0-9]+\.) /, "")) end()
      for (i = 1; i <= NF; ++i) {
        ++words
        if ($i ~ /[.!?][)"*_`]*$/) end()
      }
    }
    END { end() }' "$file" | sort -n)
  count=$(wc -l <<<"$lengths")
  nth() { sed -n "$((count * $1 / 100 + 1))p" <<<"$lengths"; }
  median=$(nth 50) p90=$(nth 90) longest=$(tail -1 <<<"$lengths")
  printf '%-28s %9d %7d %5d %8d\n' "$file" "$count" "$median" "$p90" "$longest"
  if [ $limit = 1 ] && { [ "$median" -gt 18 ] || [ "$p90" -gt 32 ]; }; then
    echo "$file: sentences are too long (median at most 18 words, 90th percentile at most 32)" >&2
    status=1
  fi
done
exit $status
