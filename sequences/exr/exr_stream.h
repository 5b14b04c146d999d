// The bytes of an OpenEXR file, for OpenEXR and for ourselves, and what goes wrong with them.
#pragma once

#include <OpenEXR/ImfIO.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace eigenlight {

/// An open file to read. Not a mapping: one that shrinks meanwhile must be an error, not a signal.
class ExrInput : public Imf::IStream {
 public:
  /// Throws BadFile naming what is no regular file, std::runtime_error naming the file else.
  explicit ExrInput(const std::filesystem::path& path);
  ~ExrInput() override;
  ExrInput(const ExrInput&) = delete;
  ExrInput& operator=(const ExrInput&) = delete;

  bool read(char to[], int count) override;
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Reads at any place, from any thread. Throws Iex::InputExc at the end of the file.
  void read_at(std::uint64_t position, void* to, std::size_t count) const;

 private:
  int descriptor_ = -1;
  std::uint64_t size_ = 0, position_ = 0;
  std::vector<char> buffer_;  // headers are read byte by byte
  std::uint64_t buffer_start_ = 0;
};

/// Runs `work`. What OpenEXR throws, or a lack of memory, becomes std::runtime_error: "PATH: WHAT:
/// reason" in one line. Other exceptions pass.
void with_exr_errors(const std::filesystem::path& path, const std::string& what,
                     const std::function<void()>& work);

}  // namespace eigenlight
