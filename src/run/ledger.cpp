#include "run/ledger.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <sstream>

namespace floe {
namespace {

constexpr double rounding = 1e-12;

bool is_lost(const std::string& name) {
  return name == "energy_damping" || name == "energy_drag" || name == "energy_fracture" ||
         name == "energy_released" || name == "energy_numerical";
}
bool is_stored(const std::string& name) {
  return name != "energy_load" && name.rfind("energy_", 0) == 0;
}

}  // namespace

double Ledger::balance(const std::vector<std::pair<std::string, double>>& forces, double kinetic,
                       double boundary) {
  double stored = kinetic, lost = 0, external = boundary;
  for (const auto& [name, value] : forces) {
    if (is_lost(name)) {
      lost += value;
    } else if (name == "energy_external") {
      external += value;
    } else if (is_stored(name)) {
      stored += value;
    }
  }
  return stored + lost - external;
}

void Ledger::take(const std::vector<std::pair<std::string, double>>& forces, double kinetic,
                  double boundary, double joined) {
  double size = std::abs(kinetic) + std::abs(boundary);
  for (const auto& [name, value] : forces) {
    if (name.rfind("energy_", 0) == 0) floor_ = std::max(floor_, rounding * std::abs(value));
    if (is_lost(name) || name == "energy_external") {
      size += std::abs(value);  // a current may add energy
    } else if (is_stored(name)) {
      size += std::abs(value - first_.try_emplace(name, value).first->second);
    }
  }
  const double sum = balance(forces, kinetic, boundary) - joined;
  if (!started_) {
    offset_ = sum;
    started_ = true;
  }
  kinetic_ = kinetic;
  boundary_ = boundary;
  error_ = sum - offset_;
  largest_ = std::max(largest_, size);
}

double Ledger::relative_error() const { return std::abs(error_) / std::max(largest_, floor_); }

void Ledger::persist(Archive& archive) {
  archive.common("started", started_);
  for (const auto& [name, value] :
       std::initializer_list<std::pair<const char*, double*>>{{"offset", &offset_},
                                                              {"kinetic", &kinetic_},
                                                              {"boundary", &boundary_},
                                                              {"error", &error_},
                                                              {"largest", &largest_}})
    archive.common(name, *value, value == &largest_ ? not_negative : finite);
  std::string names;
  std::vector<double> values;
  for (const auto& [name, value] : first_) {
    names += name + " ";
    values.push_back(value);
  }
  archive.common("first_names", names);
  archive.common("first_values", values);
  std::istringstream words(names);
  std::size_t k = 0;
  for (std::string name; words >> name && k < values.size();) first_[name] = values[k++];
}

std::vector<std::pair<std::string, double>> Ledger::columns() const {
  return {{"energy_kinetic", kinetic_},
          {"energy_boundary", boundary_},
          {"energy_balance_error", error_}};
}

}  // namespace floe
