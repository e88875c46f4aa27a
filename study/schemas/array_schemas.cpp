// The keys of arrays of devices, mounts and air bearings.
#include "study/device_arrays.h"
#include "study/tables/rows.h"

namespace chladni::study {
namespace {

template <typename Plan>
Key<Plan> centre() {
  return {.text = {"centre", "two quantities in m", "[0, 0]", "of the array, seen from above"},
          .json_name = "centre_m",
          .read =
              [](TableReader& table, Plan& plan) {
                if (const auto centre = table.quantities("centre", "m", 2)) plan.centre = *centre;
              },
          .json = [](const Plan& plan) { return io::Json(plan.centre); }};
}

/// A whole number that must be given.
template <typename Plan>
Key<Plan> needed_whole(const std::string& name, int least, int most, int Plan::*value,
                       const std::string& meaning) {
  auto key = whole(name, least, most, value, meaning, "needed");
  key.read = [=](TableReader& table, Plan& plan) {
    if (!table.has(name)) table.missing(name, fmt::format("{} to {}", least, most));
    plan.*value = static_cast<int>(table.integer(name, least, most).value_or(0));
  };
  return key;
}

}  // namespace

const Schema<RingPlan>& ring_schema() {
  using P = RingPlan;
  static const Schema<P> schema = {
      "sensor.at.ring",
      {needed_whole("count", 1, 1000, &P::count, "places, evenly spaced"),
       needed("radius", "m", &P::radius, "of the ring"),
       quantity("start", "rad", Sign::any, &P::start, "angle of the first from x", "\"0 deg\""),
       centre<P>()}};
  return schema;
}

const Schema<HexagonPlan>& hexagon_schema() {
  using P = HexagonPlan;
  static const Schema<P> schema = {
      "sensor.at.hexagon",
      {needed_whole("rings", 0, 20, &P::rings, "around the place in the centre"),
       needed("pitch", "m", &P::pitch, "between neighbours"),
       quantity("start", "rad", Sign::any, &P::start, "angle of a corner from x", "\"0 deg\""),
       centre<P>()}};
  return schema;
}

const Schema<MountPlan>& mount_schema() {
  using P = MountPlan;
  static const Schema<P> schema = {
      "[attachment]",
      {needed("stiffness", "N/m", &P::stiffness, "along z, of each contact pair"),
       quantity("lateral_stiffness", "N/m", Sign::positive, &P::lateral_stiffness,
                "across the groove, in the plane", "that of stiffness"),
       quantity("damping", "N s/m", Sign::not_negative, &P::damping, "along z"),
       quantity("lateral_damping", "N s/m", Sign::not_negative, &P::lateral_damping,
                "across the groove"),
       special<P>({"groove", R"("x", "-y", or three numbers)", "towards the centre of the array",
                   "along which the ball is free"},
                  "groove", not_shown<P>),
       quantity("footprint", "m", Sign::not_negative, &P::footprint,
                "diameter over which each spring is spread evenly", "a point")}};
  return schema;
}

const Schema<AirBearingPlan>& air_bearing_schema() {
  using P = AirBearingPlan;
  static const Schema<P> schema = {
      "[attachment]",
      {needed("stiffness", "N/m", &P::stiffness, "of the pad along its direction"),
       needed("diameter", "m", &P::diameter,
              "of the pad; its tilting stiffness is stiffness diameter^2 / 16"),
       quantity("damping", "N s/m", Sign::not_negative, &P::damping, "along its direction"),
       special<P>({"direction", R"("x", "-z", ... or three numbers)", "\"z\"",
                   "along which the film is stiff"},
                  "direction", not_shown<P>)}};
  return schema;
}

}  // namespace chladni::study
