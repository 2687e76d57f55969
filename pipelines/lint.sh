#!/bin/sh
# clang-format over all sources, clang-tidy over those that the compilation database knows.
set -eu
cd "$(dirname "$0")/.."
git ls-files '*.cpp' '*.hpp' | xargs clang-format --dry-run --Werror
[ -f build/compile_commands.json ] || cmake --preset release >/dev/null
git ls-files 'common/*.cpp' 'segment/*.cpp' 'mesher/*.cpp' 'crimp/*.cpp' 'deploy/*.cpp' 'cycle/*.cpp' 'pipelines/*.cpp' |
  xargs -P 2 -n 4 clang-tidy -p build --quiet
