#include "rsi/telegram/signal_flow.hpp"

#include <algorithm>

#include "rsi/ascii.hpp"

namespace rsi {
namespace {

std::string folded(std::string_view id) {
  std::string text(id);
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace

bool SignalFlow::add(std::string_view id, bool from_outside) {
  const bool is_new = by_id_.try_emplace(std::string(id), nodes_.size()).second;
  by_id_in_any_case_.try_emplace(folded(id), nodes_.size());
  nodes_.push_back(
      {.name = id.empty() ? "(no name)" : printable(id), .from_outside = from_outside});
  return is_new;
}

std::size_t SignalFlow::of(std::string_view id) const {
  if (const auto same = by_id_.find(std::string(id)); same != by_id_.end()) return same->second;
  const auto similar = by_id_in_any_case_.find(folded(id));
  return similar == by_id_in_any_case_.end() ? none : similar->second;
}

void SignalFlow::link(std::size_t from, std::size_t to) {
  nodes_[from].feeds.push_back(to);
  nodes_[to].fed = true;
}

void SignalFlow::trace() {
  const auto all_that = [this](auto holds) {
    std::vector<std::size_t> front;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (!nodes_[i].reached && holds(nodes_[i])) front.push_back(i);
    return front;
  };
  spread(all_that([](const Node& node) { return node.from_outside; }));
  spread(all_that([](const Node& node) { return !node.fed; }));
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (!nodes_[i].reached) spread({i});
}

void SignalFlow::spread(std::vector<std::size_t> front) {
  for (const auto start : front) nodes_[start].reached = true;
  while (!front.empty()) {
    std::vector<std::size_t> next;
    for (const auto from : front)
      for (const auto to : nodes_[from].feeds) {
        if (nodes_[to].reached) continue;
        nodes_[to].reached = true;
        nodes_[to].before = from;
        next.push_back(to);
      }
    front = std::move(next);
  }
}

std::string SignalFlow::path(std::size_t object) const {
  constexpr std::size_t kMost = 8;
  std::vector<std::size_t> back;  // the way, from its end
  for (auto at = object; at != none; at = nodes_[at].before) back.push_back(at);
  std::string text;
  for (std::size_t left = back.size(); left > 0; --left) {
    if (left + 1 == back.size() && left > kMost - 1) {
      text += " -> ...";
      left = kMost - 1;
    }
    text += (text.empty() ? "" : " -> ") + nodes_[back[left - 1]].name;
  }
  return text;
}

}  // namespace rsi
