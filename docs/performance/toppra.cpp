// toppra's timing of paths under limits of speed and torque, timed as motion/benches/timing.rs times Takt's: the same
// arms, paths and limits. docs/performance/timing.sh builds and runs both in turn.
//
//   toppra NAME ARM PATHS
//
// ARM is as arms_for_pinocchio.py writes it, PATHS as the benchmark writes it: number of joints, limits of speed, limits
// of torque, then for each path the coefficients of each joint, lowest power first.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <pinocchio/algorithm/rnea.hpp>

#include <toppra/algorithm/toppra.hpp>
#include <toppra/constraint/joint_torque.hpp>
#include <toppra/constraint/linear_joint_velocity.hpp>
#include <toppra/geometric_path/piecewise_poly_path.hpp>
#include <toppra/solver/seidel.hpp>

#include "arm.hpp"

constexpr int DEGREE = 5;
constexpr int REPEATS = 12;

struct Torque : toppra::constraint::JointTorque {
    const pin::Model &model;
    pin::Data data;
    Torque(const pin::Model &model, const Eigen::VectorXd &limit)
        : JointTorque(-limit, limit, Eigen::VectorXd::Zero(limit.size())), model(model), data(model) {}
    void computeInverseDynamics(const toppra::Vector &q, const toppra::Vector &v, const toppra::Vector &a,
                                toppra::Vector &tau) override {
        tau = pin::rnea(model, data, q, v, a);
    }
};

// Speeds as toppra has them: squares of the path's speed at the nodes, even acceleration between them.
double duration(const toppra::ParametrizationData &data) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i + 1 < data.gridpoints.size(); ++i) {
        const double speeds = std::sqrt(std::max(data.parametrization[i], 0.0)) + std::sqrt(std::max(data.parametrization[i + 1], 0.0));
        sum += 2.0 * (data.gridpoints[i + 1] - data.gridpoints[i]) / speeds;
    }
    return sum;
}

int main(int count, char **arguments) {
    if (count != 4) {
        std::fprintf(stderr, "toppra NAME ARM PATHS\n");
        return 2;
    }
    const std::string name = arguments[1];
    const pin::Model model = read(arguments[2]);
    std::ifstream text(arguments[3]);
    int joints = 0;
    text >> joints;
    Eigen::VectorXd speed(joints), torque(joints);
    for (int i = 0; i < joints; ++i) {
        text >> speed[i];
    }
    for (int i = 0; i < joints; ++i) {
        text >> torque[i];
    }
    std::vector<std::shared_ptr<toppra::PiecewisePolyPath>> paths;
    for (;;) {
        toppra::Matrix coefficients(DEGREE + 1, joints);
        for (int joint = 0; joint < joints; ++joint) {
            for (int power = 0; power <= DEGREE; ++power) {
                text >> coefficients(DEGREE - power, joint);
            }
        }
        if (!text) {
            break;
        }
        paths.push_back(std::make_shared<toppra::PiecewisePolyPath>(toppra::Matrices{coefficients}, std::vector<double>{0.0, 1.0}));
    }
    for (const int intervals : {100, 500, 1000}) {
        std::vector<double> times;
        double sum = 0.0;
        for (const auto &path : paths) {
            double fastest = INFINITY;
            double lasts = NAN;
            for (int repeat = 0; repeat < REPEATS; ++repeat) {
                const auto began = std::chrono::steady_clock::now();
                auto by_speed = std::make_shared<toppra::constraint::LinearJointVelocity>(-speed, speed);
                auto by_torque = std::make_shared<Torque>(model, torque);
                by_torque->discretizationType(toppra::Interpolation);
                toppra::algorithm::TOPPRA timing({by_speed, by_torque}, path);
                timing.setGridpoints(toppra::Vector::LinSpaced(intervals + 1, 0.0, 1.0));
                timing.solver(std::make_shared<toppra::solver::Seidel>());
                const auto code = timing.computePathParametrization(0.0, 0.0);
                const double found = duration(timing.getParameterizationData());
                const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - began;
                fastest = std::min(fastest, took.count());
                lasts = code == toppra::ReturnCode::OK ? found : NAN;
            }
            times.push_back(fastest);
            sum += lasts;
        }
        std::sort(times.begin(), times.end());
        std::printf("%s/interpolated_%d %.2f %.2f\n", name.c_str(), intervals, times[times.size() / 2], times[0]);
        std::printf("%s/interpolated_%d/value %.9g 0\n", name.c_str(), intervals, sum);
    }
}
