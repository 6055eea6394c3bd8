#include "rsi/capture/conversation.hpp"

#include <algorithm>
#include <map>

#include "rsi/ascii.hpp"
#include "rsi/capture/capture_reader.hpp"
#include "rsi/counted.hpp"

namespace rsi {
namespace {

/// Whether a start tag of this name is in `text`.
bool has_element(std::string_view text, std::string_view name) noexcept {
  for (auto at = text.find('<'); at != text.npos; at = text.find('<', at + 1)) {
    const auto end = at + 1 + name.size();
    if (end >= text.size()) return false;
    const bool name_ends = is_blank(text[end]) || text[end] == '>' || text[end] == '/';
    if (name_ends && equal_ignoring_case(text.substr(at + 1, name.size()), name)) return true;
  }
  return false;
}

std::string with_count(const ConversationSearch::Found& found) {
  return text(found.conversation) + " (" + counted(found.telegrams, "telegram") + ")";
}

std::string listed(const std::vector<ConversationSearch::Found>& all) {
  constexpr std::size_t shown = 8;
  std::string list;
  for (std::size_t i = 0; i < std::min(all.size(), shown); ++i)
    list += (i > 0 ? ", " : "") + with_count(all[i]);
  if (all.size() > shown) list += " and " + std::to_string(all.size() - shown) + " more";
  return list;
}

std::string filter_text(const ConversationFilter& filter) {
  std::string text;
  if (filter.port) text += " on port " + std::to_string(*filter.port);
  if (filter.controller) text += " with a controller at " + address_text(*filter.controller);
  return text;
}

/// Sets what was chosen, and the note about it, once something was found.
void choose(ConversationSearch& search, const ConversationFilter& filter) {
  auto candidates = search.found;
  std::erase_if(candidates, [](const auto& found) { return !found.admitted; });
  if (candidates.empty()) {
    search.note = "no RSI conversation" + filter_text(filter) + ", but " + listed(search.found) +
                  ": choose one of these by --port or --controller";
    return;
  }
  const auto busiest =
      std::max_element(candidates.begin(), candidates.end(),
                       [](const auto& a, const auto& b) { return a.telegrams < b.telegrams; });
  search.chosen = busiest->conversation;
  if (candidates.size() == 1) return;
  search.note = std::to_string(candidates.size()) +
                " RSI conversations; taken: " + with_count(*busiest) + ", not taken: ";
  candidates.erase(busiest);
  search.note += listed(candidates) + ": choose another by --port or --controller";
}

}  // namespace

Direction Conversation::direction(const Datagram& datagram) const noexcept {
  if (datagram.source.address == controller && datagram.destination == sweepd)
    return Direction::from_controller;
  if (datagram.source == sweepd && datagram.destination.address == controller)
    return Direction::to_controller;
  return Direction::other;
}

std::string text(const Conversation& conversation) {
  return address_text(conversation.controller) + " with " + text(conversation.sweepd);
}

bool looks_like_telegram(std::string_view payload) noexcept {
  constexpr std::size_t searched = 256;  // room for an XML declaration, a byte count, blanks
  constexpr std::size_t short_telegram = 100;
  if (has_element(payload.substr(0, searched), "Rob")) return true;
  return payload.size() < short_telegram && has_element(payload, "IPOC") &&
         !has_element(payload, "Sen");
}

bool ConversationFilter::admits(const Conversation& conversation) const noexcept {
  return (!port || conversation.sweepd.port == *port) &&
         (!controller || conversation.controller == *controller);
}

ConversationSearch find_conversation(std::span<const std::filesystem::path> captures,
                                     const ConversationFilter& filter,
                                     std::uint64_t telegram_limit) {
  ConversationSearch search;
  std::map<Conversation, std::size_t> place;  // in search.found
  std::uint64_t busiest = 0;                  // of the admitted: strangers do not end the search
  CaptureCounters seen;
  std::string trouble;

  for (const auto& path : captures) {
    CaptureReader reader(path);
    while (busiest < telegram_limit) {
      const auto datagram = reader.next();
      if (!datagram) break;
      if (!looks_like_telegram(datagram->payload)) continue;
      const Conversation key{datagram->source.address, datagram->destination};
      const auto [entry, is_new] = place.try_emplace(key, search.found.size());
      if (is_new) search.found.push_back({key, 0, filter.admits(key)});
      auto& found = search.found[entry->second];
      ++found.telegrams;
      if (found.admitted) busiest = std::max(busiest, found.telegrams);
    }
    seen.packets += reader.counters().packets;
    seen.udp += reader.counters().udp;
    for (const auto& note : reader.notes()) trouble += "; " + note;
  }

  if (search.found.empty())
    search.note =
        (seen.udp > 0 || seen.packets == 0
             ? "no RSI among " + counted(seen.udp, "UDP datagram") + " (IPv4) in " +
                   counted(seen.packets, "packet")
             : "none of " + counted(seen.packets, "packet") +
                   " is UDP over IPv4, in which RSI comes (IPv6, MPLS and tunnels are not "
                   "read)") +
        ": capture on the machine that answers the controller, or on a mirror "
        "port, while RSI is on (RSI over TCP is not read: let `sweepd run` record it)" +
        trouble;
  else
    choose(search, filter);
  return search;
}

}  // namespace rsi
