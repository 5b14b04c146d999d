// The blocks of one row of blocks within a tile; see planar_blocks.h.
#pragma once

#include <cmath>

#include "spatial/planar_blocks.h"

namespace eigenlight {

/// |1 - N_p . N_q| in one plane: an angle of 0.08 degrees, or a weight of 0.99994. Unit normals in
/// float are off by 1e-7.
inline constexpr float kPlanarTurn = 1e-6f;

/// Fills blocks[i] for the block that starts at column area.x0 + 8 i; `area` is one row of blocks,
/// cut off by the image.
void find_planes(const FrameInput& guides, float tolerance, const Rect& area,
                 PlanarBlocks::Block* blocks);

}  // namespace eigenlight
