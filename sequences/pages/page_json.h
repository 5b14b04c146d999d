// What a page's script reads.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "sequences/pages/page.h"

namespace eigenlight {

/// All of `page` but its title. Numbers that are not finite become null. Throws as to_html() does.
///   subtitle, names
///   background   {label, names}
///   sections     [{title, note, plots, tables, galleries}]
///   plots        [{title, note, x, y, stacked, frames, off_scale, series}]
///     x, y       {label, log, zero}
///     series     with frames [{name, y}], one value a frame; else [{name, x, y, labels, front}],
///                where labels and front are empty if no point has them
///   tables       [{title, note, names, columns, rows: [{name, total, cells, best}]}]
///   galleries    [{title, note, fps, split, width, height, frames, kinds, tiles}]
///     kinds      [{name, note, ramp, low, high}]
///     tiles      [{name, pictures: by kind and frame}]
[[nodiscard]] nlohmann::ordered_json page_json(const Page& page);

}  // namespace eigenlight
