#include "run/supply.h"

namespace floe {

void IceAmount::persist(Archive& archive, const std::string& name) {
  archive.common(name + "_bodies", bodies, not_negative);
  archive.common(name + "_mass", mass, not_negative);
  for (std::size_t k = 0; k < momentum.size(); ++k)
    archive.common(name + "_momentum_" + std::string(component_names[k]), momentum[k]);
  archive.common(name + "_energy", energy);
}

void IceAccount::persist(Archive& archive) {
  archive.common("bodies", bodies, not_negative);
  joined.persist(archive, "supplied");
  left.persist(archive, "removed");
}

std::vector<std::pair<std::string, double>> IceAccount::columns() const {
  std::vector<std::pair<std::string, double>> all{{"bodies", bodies}};
  for (const auto& [name, amount] :
       {std::pair<std::string, const IceAmount*>{"supplied", &joined}, {"removed", &left}}) {
    all.emplace_back("bodies_" + name, amount->bodies);
    all.emplace_back("mass_" + name, amount->mass);
    for (std::size_t k = 0; k < amount->momentum.size(); ++k)
      all.emplace_back("momentum_" + name + "_" + std::string(component_names[k]),
                       amount->momentum[k]);
    all.emplace_back("energy_" + name, amount->energy);
  }
  return all;
}

}  // namespace floe
