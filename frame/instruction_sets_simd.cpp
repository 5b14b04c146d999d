#include <hwy/targets.h>

#include "frame/instruction_sets.h"

namespace eigenlight {

void for_each_instruction_set(const std::function<void(std::string_view)>& body) {
  struct Restore {
    ~Restore() {
      hwy::SetSupportedTargetsForTest(0);
      hwy::GetChosenTarget().DeInit();
    }
  } restore;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    body(hwy::TargetName(target));
  }
}

}  // namespace eigenlight
