// Denoisers that are programs of their own, as methods to compare with.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "frame/frame.h"

namespace eigenlight {

/// A program that reads noisy frames from EXR files and writes denoised ones. Its command line is a
/// shell's, with places to fill in; paths are put in quoted:
///   {color}       R,G,B: what is measured, noisy: albedo * raw indirect light, linear
///   {albedo}      R,G,B
///   {normal}      X,Y,Z, world space, unit; 0 without surface
///   {output}      where it writes R,G,B: the same without noise
///   {frame}       the number of the frame
///   {frames}      the frames that are measured, such as 40-59
///   {all_frames}  these and the frames before them that build up history
/// All files are 32-bit float EXR. With {frames} or {all_frames} it runs once for a sequence, and
/// the paths are patterns with %04d; without, once for each frame that is measured.
struct ExternalMethod {
  std::string name;
  std::string command;
  /// ECMAScript; group 1 of every match in what it prints are milliseconds of filtering, which are
  /// summed. Empty: its CPU time counts, start, reading and writing included.
  std::string time_pattern;

  [[nodiscard]] bool wants(std::string_view place) const;  ///< whether {place} is in its command
  [[nodiscard]] bool runs_per_sequence() const;
  /// Whether it wants the frames before the measured ones too.
  [[nodiscard]] bool takes_all_frames() const;
};

/// From `NAME=command`, checked. Throws std::invalid_argument if there is no name, an unknown
/// {place}, no {color} or no {output}, or {frame} together with {frames}.
[[nodiscard]] ExternalMethod parse_external(std::string_view text);

/// Sets the time pattern of the one of `methods` that `NAME=REGEX` names. Throws
/// std::invalid_argument listing the names if it is none, or if the expression cannot be read or
/// has no group.
void set_external_time(std::string_view text, std::vector<ExternalMethod>& methods);

/// What its runs cost, over all frames that it was given.
struct ExternalCost {
  double ms = 0.0;       ///< a frame
  double peak_mb = 0.0;  ///< of the program, 10^6 bytes
};

/// What it is given of a frame. `albedo` and `normal` are read only if its command wants them.
struct ExternalInputs {
  int frame = 0;
  const Planes<3>& color;
  const Planes<3>& albedo;
  const Planes<3>& normal;
};

/// Feeds one external method from a scratch directory, which must be empty and stays the caller's.
class ExternalRun {
 public:
  struct Frames {
    std::vector<int> all, measured;  ///< ascending; measured are the last of all
  };

  ExternalRun(const ExternalMethod& method, Frames frames, std::filesystem::path scratch);

  /// Whether the method is to see a frame.
  [[nodiscard]] bool takes(int frame) const;
  /// Writes the inputs of a frame that it takes.
  void add(const ExternalInputs& inputs) const;
  /// The same of albedo * light of a frame that was rendered, if it takes it.
  void add(const Frame& frame) const;
  /// Runs the program over all frames. Between two runs `stops` is asked. Throws std::runtime_error
  /// naming the method, and what it printed first, if it fails, leaves no output of a frame, or if
  /// its time is not in what it prints. False if it was stopped.
  [[nodiscard]] bool run(const std::function<bool()>& stops, ExternalCost& cost) const;
  [[nodiscard]] std::filesystem::path output_path(int frame) const { return path("output", frame); }
  /// Denoised albedo * indirect light. Throws std::runtime_error naming the file if it is of
  /// another size or cannot be read.
  [[nodiscard]] Planes<3> output(int frame, Extent extent) const;

 private:
  [[nodiscard]] const std::vector<int>& frames() const;
  [[nodiscard]] std::string path(std::string_view role, int frame) const;
  [[nodiscard]] std::string fill(int frame) const;

  const ExternalMethod& method_;
  Frames frames_;
  std::filesystem::path scratch_;
};

}  // namespace eigenlight
