#!/bin/sh
# clang-format over all sources, clang-tidy over those that the compilation database knows: all of them, which takes
# long, or with SINCE=<commit> those that changed since then.
set -eu
cd "$(dirname "$0")/.."
git ls-files '*.cpp' '*.hpp' | xargs clang-format --dry-run --Werror
[ -f build/compile_commands.json ] || cmake --preset release >/dev/null
cmake --build build --target valsalva_version >/dev/null  # the only header that is generated
folders='common segment mesher crimp deploy cycle pipelines'
if [ -n "${SINCE:-}" ]; then
  # shellcheck disable=SC2086
  files=$(git diff --name-only --diff-filter=d "$SINCE" -- $folders | grep '\.cpp$' || true)
else
  # shellcheck disable=SC2086
  files=$(git ls-files $folders | grep '\.cpp$')
fi
files=$(echo "$files" | grep -v '^segment/image_file.cpp$' || true)  # Debian's ITK refuses to be read by clang
[ -z "$files" ] || echo "$files" | xargs -P 2 -n 4 clang-tidy -p build --quiet
