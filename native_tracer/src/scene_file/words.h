// The words of a scene file, one after the other, as far as they are what most files have: ASCII without control
// characters, plain decimals. Whatever else there is may be right or wrong: the parser in Python knows, and says so.

#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <system_error>

namespace whitted::scene_file {

// Thrown at what is not read here.
struct Unusual {};

class Words {
 public:
    explicit Words(std::string_view text) : text_(text) {
        if (text.find('\0') != text.npos) {
            throw Unusual{};
        }
        if (text.starts_with("\xef\xbb\xbf")) {
            at_ = 3;  // a byte order mark
        }
    }

    // The next word; empty at the end of the text.
    std::string_view next() {
        skip_blanks();
        const std::size_t start = at_;
        while (at_ < text_.size() && !is_blank(text_[at_]) && text_[at_] != '#') {
            if (text_[at_] <= ' ' || text_[at_] > '~') {  // also every byte beyond ASCII
                throw Unusual{};
            }
            ++at_;
        }
        return text_.substr(start, at_ - start);
    }

    // The next word, without taking it.
    std::string_view peek() {
        skip_blanks();  // so that lines are not counted twice
        const std::size_t start = at_;
        const std::string_view word = next();
        at_ = start;
        return word;
    }

    // Number, from 1, of the line on which the last word stands, or the next one after `peek`.
    long line() const { return line_; }

    // The next word as a finite number.
    double number() {
        std::string_view word = next();
        if (word.starts_with('+')) {
            word.remove_prefix(1);
            if (word.starts_with('-')) {
                throw Unusual{};
            }
        }
        double value = 0;
        const char* end = word.data() + word.size();
        const auto [last, error] = std::from_chars(word.data(), end, value);
        if (error != std::errc{} || last != end || !std::isfinite(value)) {  // it takes `inf` and `nan`
            throw Unusual{};
        }
        return value;
    }

    // The next word as a whole number that is not negative.
    std::size_t whole() {
        std::string_view word = next();
        if (word.starts_with('+')) {
            word.remove_prefix(1);
        }
        std::size_t value = 0;
        const char* end = word.data() + word.size();
        const auto [last, error] = std::from_chars(word.data(), end, value);
        if (error != std::errc{} || last != end) {
            throw Unusual{};
        }
        return value;
    }

 private:
    static bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }

    bool ends_line() const {
        return text_[at_] == '\n' || (text_[at_] == '\r' && (at_ + 1 == text_.size() || text_[at_ + 1] != '\n'));
    }

    void skip_blanks() {
        for (; at_ < text_.size(); ++at_) {
            if (text_[at_] == '#') {
                skip_comment();
                if (at_ == text_.size()) {
                    return;
                }
            } else if (!is_blank(text_[at_])) {
                return;
            }
            line_ += ends_line() ? 1 : 0;
        }
    }

    // Go to where the line ends.
    void skip_comment() {
        const std::string_view before = text_.substr(0, at_);
        if (before.ends_with("1.")) {  // it may be `1.#INF`
            throw Unusual{};
        }
        at_ = std::min(text_.find_first_of("\r\n", at_), text_.size());
    }

    std::string_view text_;
    std::size_t at_ = 0;
    long line_ = 1;
};

}  // namespace whitted::scene_file
