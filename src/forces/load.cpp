#include "floe/forces/load.h"

namespace floe {
namespace {

/// Three columns of the table of a load.
Point3 in_table(const TimeTable& table, std::size_t first, double time) {
  return {table.value(first, time), table.value(first + 1, time), table.value(first + 2, time)};
}

}  // namespace

Point3 Load::force_at(double time) const {
  return table.empty() ? ramp.value(time) * force : in_table(table, 0, time);
}

Point3 Load::moment_at(double time) const {
  return table.empty() ? ramp.value(time) * moment : in_table(table, 3, time);
}

}  // namespace floe
