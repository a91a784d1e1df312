#!/bin/sh
# Takt's timing of paths and toppra's (C++, with Pinocchio's dynamics) in turn, on the same arms, paths and limits: medians
# over rounds, and their ratios.
#
#   python3 -m venv peers && peers/bin/pip install pin==4.1.0
#   apt-get install clang g++ libeigen3-dev
#   (hungpham2511/toppra checked out at 730aa8a, version 0.6.2, in the folder TOPPRA)
#   PYTHON=peers/bin/python TOPPRA=toppra docs/performance/timing.sh [rounds]
#
# Takt is as it is shipped (lanes are chosen at run time); toppra is built for this processor, by Clang and by GCC.
set -eu
toppra=$(cd "$TOPPRA/cpp/src" && pwd)
cd "$(dirname "$0")/../.."
rounds=${1:-7}
python=${PYTHON:-python3}
work=target/timing
mkdir -p "$work/include/toppra"

# What toppra's own build would generate.
printf '#pragma once\n#define TOPPRA_EXPORT\n#define TOPPRA_NO_EXPORT\n#define TOPPRA_DEPRECATED\n' > "$work/include/toppra/export.hpp"
prefix=$("$python" -c 'import pathlib, pinocchio; print(pathlib.Path(pinocchio.__file__).parents[4])')
for compiler in clang++ g++; do
    "$compiler" -O3 -march=native -DNDEBUG -std=c++17 -w \
        -DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_LIMIT_VECTOR_SIZE=30 -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS \
        -DBOOST_FUSION_INVOKE_MAX_ARITY=12 -I"$work/include" -I"$toppra" -I"$prefix/include" -I/usr/include/eigen3 \
        docs/performance/toppra.cpp "$toppra"/toppra/*.cpp "$toppra"/toppra/algorithm/*.cpp \
        "$toppra"/toppra/constraint/linear*.cpp "$toppra"/toppra/constraint/joint_torque.cpp \
        "$toppra"/toppra/solver/seidel.cpp "$toppra"/toppra/geometric_path/*.cpp -o "$work/toppra-$compiler"
done

# The bench's path is in what cargo prints.
bench=$(cargo bench --quiet --package takt-motion --bench timing --no-run --message-format=json |
    sed -n 's/.*"executable":"\([^"]*timing-[^"]*\)".*/\1/p')
cp "$bench" "$work/takt"
"$work/takt" --paths "$work"
for arm in ur5e fr3; do
    "$python" docs/performance/arms_for_pinocchio.py "tests/vectors/robots/$arm/$arm.urdf" > "$work/$arm.txt"
done

: > "$work/figures"
for round in $(seq "$rounds"); do
    "$work/takt" | sed "s/^/takt /" >> "$work/figures"
    for compiler in clang++ g++; do
        for arm in ur5e fr3; do
            "$work/toppra-$compiler" "$arm" "$work/$arm.txt" "$work/$arm.paths" | sed "s/^/toppra-$compiler /" >> "$work/figures"
        done
    done
done

"$python" docs/performance/compare.py "$work/figures" us
