#include "floe/water/water_motion.h"

namespace floe {

Point3 WaterMotion::velocity(double time) const {
  Point3 v = current;
  if (!current_table.empty())
    v = {current_table.value(0, time), current_table.value(1, time), current_table.value(2, time)};
  if (!level_table.empty()) v.z += level_table.rate(0, time);
  return v;
}

Point3 WaterMotion::acceleration(double time) const {
  Point3 a{};
  if (!current_table.empty())
    a = {current_table.rate(0, time), current_table.rate(1, time), current_table.rate(2, time)};
  if (!level_table.empty()) a.z += level_table.second(0, time);
  return a;
}

}  // namespace floe
