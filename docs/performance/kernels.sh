#!/bin/sh
# Takt's kernels and Pinocchio's in turn, on the same arms and states: medians over rounds, and their ratios.
#
#   python3 -m venv peers && peers/bin/pip install pin==4.1.0
#   apt-get install clang g++ libeigen3-dev
#   PYTHON=peers/bin/python docs/performance/kernels.sh [rounds]
#
# Takt is built twice: as it is shipped (lanes are chosen at run time), and for this processor alone. Pinocchio is built
# for this processor, by Clang and by GCC.
set -eu
cd "$(dirname "$0")/../.."
rounds=${1:-15}
python=${PYTHON:-python3}
work=target/kernels
mkdir -p "$work"

prefix=$("$python" -c 'import pathlib, pinocchio; print(pathlib.Path(pinocchio.__file__).parents[4])')
for arm in ur5e fr3; do
    "$python" docs/performance/arms_for_pinocchio.py "tests/vectors/robots/$arm/$arm.urdf" > "$work/$arm.txt"
done
for compiler in clang++ g++; do
    "$compiler" -O3 -march=native -DNDEBUG -std=c++17 -w \
        -DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_LIMIT_VECTOR_SIZE=30 -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS \
        -DBOOST_FUSION_INVOKE_MAX_ARITY=12 -I"$prefix/include" -I/usr/include/eigen3 \
        docs/performance/pinocchio.cpp -o "$work/pinocchio-$compiler"
done

# The bench's path is in what cargo prints.
built() {
    cargo bench --quiet --package takt-motion --bench kernels --no-run --message-format=json "$@" |
        sed -n 's/.*"executable":"\([^"]*kernels-[^"]*\)".*/\1/p'
}
cp "$(built)" "$work/takt-shipped"
cp "$(RUSTFLAGS='-C target-cpu=native' built --target-dir target/native)" "$work/takt-native"

: > "$work/figures"
for round in $(seq "$rounds"); do
    for build in takt-shipped takt-native; do
        "$work/$build" | sed "s/^/$build /" >> "$work/figures"
    done
    for compiler in clang++ g++; do
        "$work/pinocchio-$compiler" "$work/ur5e.txt" "$work/fr3.txt" | sed "s/^/pinocchio-$compiler /" >> "$work/figures"
    done
done

"$python" docs/performance/compare.py "$work/figures" ns
