// One part of an OpenEXR file encoded again, with new pixels in some of its channels.
#pragma once

#include <OpenEXR/ImfCompression.h>

#include <span>

#include "sequences/exr/exr_output.h"
#include "sequences/exr/exr_rewrite.h"
#include "sequences/exr/exr_state.h"

namespace eigenlight {

/// Writes all chunks of a part. Counts into `report`.
void encode_part(ExrFile::State& in, int part, Imf::Compression compression,
                 std::span<const ExrReplacement> replacements, ExrOutput& out,
                 ExrRewriteReport& report);

}  // namespace eigenlight
