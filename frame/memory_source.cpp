#include "frame/memory_source.h"

namespace eigenlight {

bool MemorySource::next(Frame& frame) {
  const int count = static_cast<int>(frames_.size());
  if (count == 0 || (!repeats_ && handed_out_ == count)) return false;
  copy_frame(frames_[static_cast<std::size_t>(handed_out_ % count)], frame);
  if (repeats_) {
    frame.index = handed_out_;
    frame.previous_index = handed_out_ - 1;
  }
  ++handed_out_;
  return true;
}

}  // namespace eigenlight
