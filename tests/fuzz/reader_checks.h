#pragma once
// What must hold for whatever bytes a reader is given. A text is read, or refused by an InputError, each line
// of which begins with the file's name; what was read is whole, and written and read again it is the same.
// Each function throws std::logic_error where that is not so. For the fuzzers, and for the test that reads
// their corpora.

#include <functional>
#include <string>

namespace collidoscope {

/// Whether `read` read it; if not, it threw an InputError, each line of which begins with the file's name.
bool reads(const std::string& file, const std::function<void()>& read);

void check_scene(const std::string& text);
/// Of the scene of three bodies, a generator and a joint that changed_scene() is.
void check_changes(const std::string& text);
/// As it is, and with the size and the hash that it should have, so that what lies behind them is reached.
void check_snapshot(const std::string& bytes);
/// Beside changed_scene(), and beside a scene that could not be read.
void check_criterion(const std::string& text);
void check_object(const std::string& text);

/// A scene, as a file.
std::string changed_scene();

}  // namespace collidoscope
