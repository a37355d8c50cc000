#include "sim_cuda/import/frame_text.h"

#include <fmt/format.h>

#include <charconv>
#include <cstring>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/text_rows.h"

namespace collidoscope {

std::string_view LineReader::next(const char* expected) {
  if (rest_.empty())
    throw InputError(fmt::format("{}:{}:1: the file ends, expected {}", file_, line_, expected));
  ++line_;
  return take_line(rest_);
}

void LineReader::skip_empty() {
  while (!rest_.empty()) {
    std::string_view after = rest_;
    if (!trimmed(take_line(after)).empty()) return;
    rest_ = after;
    ++line_;
  }
}

std::string_view LineReader::take(std::size_t count, std::size_t& taken) {
  const char *at = rest_.data(), *const end = at + rest_.size();
  for (taken = 0; taken < count && at < end; ++taken) {
    const void* const newline = std::memchr(at, '\n', static_cast<std::size_t>(end - at));
    at = newline == nullptr ? end : static_cast<const char*>(newline) + 1;
  }
  const std::string_view text = rest_.substr(0, static_cast<std::size_t>(at - rest_.data()));
  rest_.remove_prefix(text.size());
  line_ += taken;
  return text;
}

std::size_t LineReader::whole(std::string_view text, std::size_t most, const char* what) const {
  text = trimmed(text);
  std::size_t number = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || stop != text.data() + text.size() || number > most)
    fail(fmt::format("no {}", what), fmt::format("a whole number up to {}", most));
  return number;
}

void LineReader::fail(const std::string& problem, const std::string& expected) const {
  throw InputError(fmt::format("{}:{}:1: {}, expected {}", file_, line_ - 1, problem, expected));
}

void LineReader::fail_at_end(std::size_t taken, std::size_t count) const {
  fail(fmt::format("the file ends after {} of {} atoms", taken, count), "all");
}

void refuse_frame(const std::string& file, std::int64_t wanted, std::int64_t frames) {
  throw InputError(fmt::format("{}: no frame {}; it has {}, counted from 0", file, wanted, frames));
}

BodyTable read_frame(const std::string& file, const FrameRows& frame, const TableOptions& options,
                     BodyTable notes) {
  const std::size_t columns = frame.names.size();
  if (options.preview != nullptr) {
    preview_text(*options.preview, frame.names, columns, frame.rows, ' ', false);
    return {};
  }
  const ColumnChoice choice = choose_columns(options.columns, frame.names, columns, file);
  const TextRows rows(file, frame.rows, frame.first_line, ' ', false);
  if (rows.rows() != frame.count)
    throw InputError(
        fmt::format("{}:{}:1: {} rows, expected {} atoms", file, frame.first_line, rows.rows(), frame.count));
  BodyTableBuilder table(choice, rows.rows(), options.scale, file);
  rows.read(table.targets(columns));
  BodyTable bodies = table.finish(frame.names, columns);
  bodies.frames = notes.frames;
  bodies.notes.insert(bodies.notes.end(), notes.notes.begin(), notes.notes.end());
  return bodies;
}

}  // namespace collidoscope
