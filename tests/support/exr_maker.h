// Makes OpenEXR files of any kind: every channel holds random bits, so that halves and floats
// include NaN of any payload, Inf and subnormal values.
#pragma once

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <OpenEXR/ImfTiledOutputPart.h>

#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace eigenlight {

class ExrMaker {
 public:
  /// One part, without the attribute `type`, as old programs write it.
  static void write(const std::filesystem::path& path, const Imf::Header& header) {
    ExrMaker maker;
    if (header.hasTileDescription()) {
      Imf::TiledOutputFile file(path.c_str(), header);
      maker.write_tiles(file, header);
    } else {
      Imf::OutputFile file(path.c_str(), header);
      maker.write_lines(file, header);
    }
  }
  /// Parts with names and types.
  static void write(const std::filesystem::path& path, const std::vector<Imf::Header>& headers) {
    ExrMaker maker;
    Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
    for (int i = 0; i < static_cast<int>(headers.size()); ++i) {
      const Imf::Header& header = headers[static_cast<std::size_t>(i)];
      if (header.type() == Imf::DEEPSCANLINE) {
        Imf::DeepScanLineOutputPart part(file, i);
        maker.write_deep(part, header);
      } else if (header.type() == Imf::TILEDIMAGE) {
        Imf::TiledOutputPart part(file, i);
        maker.write_tiles(part, header);
      } else {
        Imf::OutputPart part(file, i);
        maker.write_lines(part, header);
      }
    }
  }

 private:
  static std::size_t bytes_of(const Imf::Channel& channel) {
    return channel.type == Imf::HALF ? 2 : 4;
  }

  Imf::FrameBuffer fill(const Imf::Header& header, const Imath::Box2i& window) {
    Imf::FrameBuffer frame;
    values_.clear();
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      const Imf::Channel& channel = c.channel();
      const std::size_t width = static_cast<std::size_t>(window.max.x - window.min.x + 1) /
                                static_cast<std::size_t>(channel.xSampling);
      const std::size_t height = static_cast<std::size_t>(window.max.y - window.min.y + 1) /
                                 static_cast<std::size_t>(channel.ySampling);
      values_.emplace_back(width * height * bytes_of(channel));
      for (char& byte : values_.back()) byte = static_cast<char>(random_());
      frame.insert(c.name(), Imf::Slice::Make(channel.type, values_.back().data(), window, 0, 0,
                                              channel.xSampling, channel.ySampling));
    }
    return frame;
  }

  template <typename File>
  void write_lines(File& file, const Imf::Header& header) {
    const Imath::Box2i& window = header.dataWindow();
    file.setFrameBuffer(fill(header, window));
    file.writePixels(window.max.y - window.min.y + 1);
  }

  template <typename File>
  void write_tiles(File& file, const Imf::Header& header) {
    for (int ly = 0; ly < file.numYLevels(); ++ly) {
      for (int lx = 0; lx < file.numXLevels(); ++lx) {
        if (!file.isValidLevel(lx, ly)) continue;
        file.setFrameBuffer(fill(header, file.dataWindowForLevel(lx, ly)));
        // From the last to the first: seen in files with random order.
        for (int y = file.numYTiles(ly) - 1; y >= 0; --y) {
          for (int x = file.numXTiles(lx) - 1; x >= 0; --x) file.writeTile(x, y, lx, ly);
        }
      }
    }
  }

  void write_deep(Imf::DeepScanLineOutputPart& part, const Imf::Header& header) {
    const Imath::Box2i& window = header.dataWindow();
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    const auto pixels = static_cast<std::size_t>(width * height);
    std::vector<unsigned> counts(pixels);
    for (unsigned& count : counts) count = random_() % 4;
    std::vector<std::vector<float>> samples(pixels, std::vector<float>(4));
    for (auto& pixel : samples) {
      for (float& value : pixel) value = static_cast<float>(random_() % 1000);
    }
    std::vector<std::vector<float*>> pointers;
    Imf::DeepFrameBuffer frame;
    frame.insertSampleCountSlice(Imf::Slice::Make(Imf::UINT, counts.data(), window));
    pointers.reserve(16);
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      pointers.emplace_back(pixels);
      for (std::size_t i = 0; i < pixels; ++i) pointers.back()[i] = samples[i].data();
      const std::size_t row = static_cast<std::size_t>(width) * sizeof(float*);
      char* base =
          reinterpret_cast<char*>(reinterpret_cast<std::intptr_t>(pointers.back().data()) -
                                  static_cast<std::intptr_t>(sizeof(float*)) * window.min.x -
                                  static_cast<std::intptr_t>(row) * window.min.y);
      frame.insert(c.name(), Imf::DeepSlice(Imf::FLOAT, base, sizeof(float*), row, sizeof(float)));
    }
    part.setFrameBuffer(frame);
    part.writePixels(height);
  }

  std::mt19937 random_{20120601};
  std::vector<std::vector<char>> values_;
};

/// A header with windows in the order x0, y0, x1, y1, last pixels included.
inline Imf::Header exr_header(Imath::Box2i display, Imath::Box2i data, Imf::Compression compression,
                              Imf::LineOrder order = Imf::INCREASING_Y) {
  return Imf::Header(display, data, 1, Imath::V2f(0, 0), 1, order, compression);
}

}  // namespace eigenlight
