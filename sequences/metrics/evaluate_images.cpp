#include "sequences/metrics/evaluate_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "frame/bad_file.h"
#include "sequences/exr/exr_colors.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/ldr_image.h"
#include "sequences/files/perturbation.h"
#include "sequences/metrics/layer_sequence.h"

namespace eigenlight {
namespace {

constexpr float kCyclesBackground = 1e10f;

// One file: its colors, and what it knows of surfaces and ages.
struct Source {
  std::string path;
  Planes<3> colors;
  std::optional<ExrReader> reader;  // none for 8-bit pictures
  ExrWindow window;                 // where it has pixels
};

// The layer that is measured where none was asked for.
std::string default_layer(const std::filesystem::path& reference, const std::string& prefix) {
  if (is_ldr_name(reference)) return {};
  const ExrReader reader(reference);
  const std::vector<std::string>& layers = reader.layers();
  const std::string ours = prefix.empty() ? "indirect" : prefix + ".indirect";
  return std::find(layers.begin(), layers.end(), ours) != layers.end() ? "indirect" : "color";
}

Source open_source(const std::filesystem::path& path, const std::string& layer,
                   const std::string& prefix) {
  Source source;
  source.path = path.string();
  if (is_ldr_name(path)) {
    source.colors = read_ldr_image(path);
    const Extent extent = source.colors[0].extent();
    source.window = {0, 0, extent.width, extent.height};
  } else {
    source.reader.emplace(path);
    const std::string name = prefixed_layer(*source.reader, layer, prefix);
    source.colors = source.reader->read_colors(name);
    source.window = source.reader->data_window(name);
  }
  return source;
}

void check_size(const Source& test, const Source& other) {
  const Extent a = test.colors[0].extent(), b = other.colors[0].extent();
  if (a == b) return;
  throw BadFile(fmt::format("{} is {}x{}, but {} is {}x{}", test.path, a.width, a.height,
                            other.path, b.width, b.height));
}

// Sets a bit of each pixel where `test` holds.
template <typename Test>
void mark(Plane<std::uint8_t>& bits, std::uint8_t bit, const Test& test) {
  for (int y = 0; y < bits.height(); ++y) {
    for (int x = 0; x < bits.width(); ++x) {
      if (test(x, y)) bits(x, y) = static_cast<std::uint8_t>(bits(x, y) | bit);
    }
  }
}

// Masks may stand in another part of the file, of another size.
void check_mask(const Source& source, Extent mask, const char* layer) {
  const Extent size = source.colors[0].extent();
  if (mask == size) return;
  throw std::runtime_error(fmt::format("{}: layer '{}' is {}x{}, expected {}x{}", source.path,
                                       layer, mask.width, mask.height, size.width, size.height));
}

// Runs `read` if the file has that layer. Nobody asked for it: one of another type is as good as
// none.
template <typename Read>
bool read_mask(const Source& source, const char* layer, const Read& read) {
  if (!source.reader->has_layer(layer)) return false;
  try {
    read();
    return true;
  } catch (const BadFile&) {
    return false;
  }
}

// True if the file tells surface from background.
bool mark_surface(const Source& source, LoadedFrame& out, const char* role) {
  if (!source.reader) return false;
  const bool has_ids = read_mask(source, "id", [&] {
    const Plane<std::uint32_t> id = source.reader->read_uint("id");
    check_mask(source, id.extent(), "id");
    mark(out.images.bits, kSurfaceBit, [&](int x, int y) { return id(x, y) != 0; });
    out.surface_from = fmt::format("{} id", role);
  });
  if (has_ids) return true;
  return read_mask(source, "Z", [&] {
    const Planes<1> z = source.reader->read_planes<1>("Z");
    check_mask(source, z[0].extent(), "Z");
    mark(out.images.bits, kSurfaceBit,
         [&](int x, int y) { return std::isfinite(z[0](x, y)) && z[0](x, y) < kCyclesBackground; });
    out.surface_from = fmt::format("{} Z", role);
  });
}

bool mark_ages(const Source& source, LoadedFrame& out, const char* role) {
  return source.reader && read_mask(source, "age", [&] {
           const Planes<1> age = source.reader->read_planes<1>("age");
           check_mask(source, age[0].extent(), "age");
           const Plane<std::uint8_t>& bits = out.images.bits;
           const auto has_surface = [&](int x, int y) { return (bits(x, y) & kSurfaceBit) != 0; };
           mark(out.images.bits, kYoungBit,
                [&](int x, int y) { return has_surface(x, y) && age[0](x, y) < kYoungAge; });
           mark(out.images.bits, kOldBit,
                [&](int x, int y) { return has_surface(x, y) && age[0](x, y) >= kYoungAge; });
           out.age_from = fmt::format("{} age", role);
         });
}

// What `render --perturb step` wrote to the file, if this is one of its files.
std::optional<int> step_of(const Source& source) {
  if (!source.reader) return std::nullopt;
  const auto attribute = source.reader->attribute(kPerturbAttribute);
  const auto* text = attribute ? std::get_if<std::string>(&*attribute) : nullptr;
  if (!text || !text->starts_with("step")) return std::nullopt;
  return parse_perturbation(*text).step_frame;
}

bool is_finite(const Planes<3>& colors, int x, int y) {
  return std::isfinite(colors[0](x, y)) && std::isfinite(colors[1](x, y)) &&
         std::isfinite(colors[2](x, y));
}

bool is_inside(const ExrWindow& window, int x, int y) {
  return x >= window.x && y >= window.y && x < window.x + window.width &&
         y < window.y + window.height;
}

// What no file shows, and what only some show, is no pixel to compare. No pixel at all is an error.
void check_windows(const std::vector<Source*>& sources, const LoadedFrame& out) {
  const Extent extent = out.images.bits.extent();
  if (out.outside_pixels < static_cast<std::int64_t>(extent.pixels())) return;
  throw BadFile(fmt::format("{}: no pixel lies in its data window and in that of {}",
                            sources[0]->path, sources[1]->path));
}

void note_colors(const std::vector<Source*>& sources, LoadedFrame& out) {
  const Source& test = *sources.front();
  for (const Source* other : sources) {
    if (!test.reader || !other->reader) return;
    if (same_colors(test.reader->chromaticities(), other->reader->chromaticities())) continue;
    out.note = fmt::format(
        "the primaries of {} and {} differ (chromaticities); their numbers are compared as they "
        "are",
        test.path, other->path);
    return;
  }
}

// Counts pixels with NaN or Inf per file; the first such file is named.
void mark_finite(const std::vector<Source*>& sources, LoadedFrame& out) {
  std::int64_t first_count = 0;
  const Source* first = nullptr;
  int first_x = 0, first_y = 0;
  mark(out.images.bits, kFiniteBit, [&](int x, int y) {
    bool is_good = true;
    for (const Source* source : sources) {
      if (is_inside(source->window, x, y)) continue;
      ++out.outside_pixels;
      return false;
    }
    for (const Source* source : sources) {
      if (is_finite(source->colors, x, y)) continue;
      is_good = false;
      if (!first) first = source, first_x = x, first_y = y;
      if (first == source) ++first_count;
    }
    if (!is_good) ++out.bad_pixels;
    return is_good;
  });
  if (!first) return;
  out.bad = fmt::format("{}: {} pixels with NaN or Inf, the first at ({}, {})", first->path,
                        first_count, first_x, first_y);
}

}  // namespace

LoadedFrame load_frame(int frame, const FramePaths& paths, const EvaluateOptions& options) {
  const std::string layer =
      options.layer ? *options.layer : default_layer(paths.reference, paths.prefixes[1]);
  Source test = open_source(paths.test, options.test_layer.value_or(layer), paths.prefixes[0]);
  Source reference = open_source(paths.reference, layer, paths.prefixes[1]);
  check_size(test, reference);
  std::vector<Source*> sources{&test, &reference};
  std::optional<Source> reference_b;
  if (!paths.reference_b.empty()) {
    reference_b = open_source(paths.reference_b, layer, paths.prefixes[2]);
    check_size(test, *reference_b);
    sources.push_back(&*reference_b);
  }

  LoadedFrame out;
  out.images.frame = frame;
  out.images.bits = Plane<std::uint8_t>(test.colors[0].extent());
  mark_finite(sources, out);
  check_windows(sources, out);
  note_colors(sources, out);
  if (options.takes_all_pixels ||
      (!mark_surface(test, out, "test") && !mark_surface(reference, out, "reference"))) {
    mark(out.images.bits, kSurfaceBit, [](int, int) { return true; });
    out.surface_from = "all pixels";
  }
  if (!mark_ages(test, out, "test")) (void)mark_ages(reference, out, "reference");
  out.step = step_of(test);
  if (!out.step) out.step = step_of(reference);
  out.images.test = std::move(test.colors);
  out.images.reference = std::move(reference.colors);
  if (reference_b) out.images.reference_b = std::move(reference_b->colors);
  return out;
}

}  // namespace eigenlight
