#include "sequences/pages/report.h"

#include <nlohmann/json.hpp>

#include "sequences/files/atomic_file.h"
#include "sequences/pages/page_files.h"
#include "sequences/pages/page_template.h"
#include "sequences/pages/report_data.h"
#include "sequences/pages/report_pictures.h"

namespace eigenlight {

void write_report(const std::filesystem::path& dir) {
  ReportData data = read_report_data(dir);
  PictureOptions options;
  options.exposure = data.exposure;
  options.frames_per_second = data.frames_per_second;
  data.page["pictures"] = report_pictures(dir, data.frames, options);
  write_file_atomically(dir / "index.html",
                        fill_page({kPageHtml, kPageCss, kPageJs}, data.title, data.page));
}

}  // namespace eigenlight
