// Pinocchio's inverse dynamics and mass matrix, timed as motion/benches/kernels.rs times Takt's: the same arms, the
// same states, the same batches. docs/performance/kernels.sh builds and runs both in turn.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include "arm.hpp"

constexpr int STATES = 64;
constexpr int BATCHES = 400;

// SplitMix64, as in takt_checker::draw.
struct Draw {
    std::uint64_t state;
    double between(double low, double high) {
        state += 0x9e3779b97f4a7c15ull;
        std::uint64_t z = state;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        z ^= z >> 31;
        return low + (high - low) * (static_cast<double>(z >> 11) / 9007199254740992.0);
    }
};

struct State {
    Eigen::VectorXd q, v, a;
};

template <class Work> void measure(const std::string &name, Work work) {
    std::vector<double> batches;
    for (int batch = 0; batch < BATCHES; ++batch) {
        const auto began = std::chrono::steady_clock::now();
        for (int state = 0; state < STATES; ++state) {
            work(state);
        }
        const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - began;
        batches.push_back(took.count() / STATES);
    }
    std::sort(batches.begin(), batches.end());
    std::printf("%s %.2f %.2f\n", name.c_str(), batches[BATCHES / 2], batches[0]);
}

void arm(const std::string &name, const std::string &file) {
    pin::Model model = read(file);
    pin::Data data(model);
    Draw draw{1};
    std::vector<State> states;
    for (int state = 0; state < STATES; ++state) {
        State drawn{Eigen::VectorXd(model.nq), Eigen::VectorXd(model.nv), Eigen::VectorXd(model.nv)};
        for (auto *values : {&drawn.q, &drawn.v, &drawn.a}) {
            for (int joint = 0; joint < model.nv; ++joint) {
                (*values)[joint] = draw.between(-2.0, 2.0);
            }
        }
        states.push_back(drawn);
    }
    // So that whoever compares can see that both compute the same.
    const auto &tau = pin::rnea(model, data, states[0].q, states[0].v, states[0].a);
    std::printf("%s/value %.12g\n", name.c_str(), tau.norm());
    volatile double kept = 0.0;
    measure(name + "/inverse_dynamics", [&](int state) {
        kept = pin::rnea(model, data, states[state].q, states[state].v, states[state].a)[0];
    });
    measure(name + "/mass_matrix", [&](int state) { kept = pin::crba(model, data, states[state].q)(0, 0); });
}

int main(int count, char **arguments) {
    if (count != 3) {
        std::puts("usage: pinocchio UR5E_TEXT FR3_TEXT");
        return 2;
    }
    arm("ur5e", arguments[1]);
    arm("fr3", arguments[2]);
}
