#include <sstream>

#include "output/output.h"

namespace floe {
namespace {

/// Converts a sample to numbers and the names of their columns.
void flatten(const Sample& sample, std::string& names, std::vector<double>& values) {
  names.clear();
  values = {sample.time};
  const auto add = [&](const Point3& p) { values.insert(values.end(), {p.x, p.y, p.z}); };
  for (const auto& [name, b] : sample.boundaries) {
    names += "boundary " + name + "\n";
    add(b.force), add(b.moment), add(b.displacement);
  }
  for (const auto& [name, u] : sample.loads) {
    names += "load " + name + "\n";
    add(u);
  }
  for (const auto& [name, value] : sample.forces) {
    names += "force " + name + "\n";
    values.push_back(value);
  }
}

Sample assemble(const std::string& names, const std::vector<double>& values) {
  Sample sample;
  std::size_t at = 0;
  const auto next = [&] { return at < values.size() ? values[at++] : 0.0; };
  const auto point = [&] { return Point3{next(), next(), next()}; };  // braces: in this order
  sample.time = next();
  std::istringstream words(names);
  for (std::string kind, name; words >> kind >> name;) {
    if (kind == "boundary") {
      BoundarySample& b = sample.boundaries[name];
      b.force = point(), b.moment = point(), b.displacement = point();
    } else if (kind == "load") {
      sample.loads[name] = point();
    } else {
      sample.forces.emplace_back(name, next());
    }
  }
  return sample;
}

}  // namespace

void OutputArchive::persist(Archive& archive) {
  archive.enter("output");
  for (const auto& [name, sample] :
       {std::pair<std::string, Sample*>{"first", &first}, {"last", &last}}) {
    std::string names;
    std::vector<double> values;
    flatten(*sample, names, values);
    archive.common(name + "_names", names);
    archive.common(name + "_sample", values);
    if (archive.loading()) *sample = assemble(names, values);
  }
  archive.common("row_pending", row_pending);
  archive.common("history_rows", rows);
  archive.common("fields_frames", frames);
  archive.common("pressure_rows", pressures);
  archive.common("next_history", next_history, not_negative);
  archive.common("next_fields", next_fields, not_negative);
  archive.common("next_pressure", next_pressure, not_negative);
  archive.common("run", run);
}

}  // namespace floe
