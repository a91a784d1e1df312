// An arm as arms_for_pinocchio.py writes it: the library that reads URDF is built without the processor's instructions,
// and Eigen's matrices cannot pass between the two.

#pragma once

#include <fstream>
#include <string>

#include <pinocchio/multibody.hpp>

namespace pin = pinocchio;

inline pin::Model read(const std::string &file) {
    pin::Model model;
    std::ifstream text(file);
    pin::JointIndex last = 0;
    int axis = 0;
    while (text >> axis) {
        double numbers[25];
        for (double &number : numbers) {
            text >> number;
        }
        const Eigen::Map<const Eigen::Matrix3d> rotation(numbers), inertia(numbers + 16);
        const Eigen::Map<const Eigen::Vector3d> translation(numbers + 9), center(numbers + 13);
        const pin::SE3 placement(rotation, translation);
        const std::string name = "joint" + std::to_string(last);
        if (axis == 0) {
            last = model.addJoint(last, pin::JointModelRX(), placement, name);
        } else if (axis == 1) {
            last = model.addJoint(last, pin::JointModelRY(), placement, name);
        } else {
            last = model.addJoint(last, pin::JointModelRZ(), placement, name);
        }
        model.appendBodyToJoint(last, pin::Inertia(numbers[12], center, pin::Symmetric3(Eigen::Matrix3d(inertia))));
    }
    return model;
}
