// The entries of the catalogue, one file each; their order is in catalogue.cpp.
#pragma once

#include "diagnosis/effect.h"

namespace chladni::diagnosis {

// The body.
extern const Effect youngs_modulus, density, thickness, thickness_field, modulus_field, orthotropy,
    local_stiffness, size_error, modes_above, drift;
// Attachments to it.
extern const Effect point_mass, mass_with_inertia, sensor_masses, actuator_masses, ground_spring,
    ground_damper, resonator, frame, suspension;
// Damping.
extern const Effect modal_damping, hysteretic_damping;
// The channels.
extern const Effect sensor_gain, actuator_gain, overall_gain, sensor_sign, actuator_sign,
    swapped_sensors, swapped_actuators, sensor_position, actuator_position, sensor_direction,
    actuator_direction, sensor_crosstalk, actuator_crosstalk, sensor_quantity, sensor_unit, delay,
    sensor_delay, actuator_delay, low_pass, sensor_low_pass, actuator_low_pass;

}  // namespace chladni::diagnosis
