#include "run/work_ledger.h"

namespace floe {

void WorkLedger::open(std::string_view force, std::size_t works) {
  const std::string name = "force_" + std::to_string(first_.size() - 1) + "_" + std::string(force);
  for (std::size_t w = 0; w < works; ++w)
    names_.push_back(works == 1 ? name : name + "_" + std::to_string(w));
  works_.resize(names_.size());
  first_.push_back(names_.size());
}

void WorkLedger::persist(Archive& archive) {
  archive.enter("works");
  for (std::size_t w = 0; w < works_.size(); ++w) archive.share(names_[w], works_[w]);
}

}  // namespace floe
