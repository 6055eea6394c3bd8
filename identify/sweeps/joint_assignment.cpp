#include "identify/sweeps/joint_assignment.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "identify/dh/joint_order.hpp"
#include "identify/sweeps/body_turns.hpp"
#include "identify/sweeps/fitting_orders.hpp"
#include "identify/sweeps/planned_turns.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {
namespace {

constexpr double kByChance = 20;  // differences that chance explains

using Order = std::vector<std::size_t>;

std::string names(const Order& joints) {
  std::string text;
  for (const std::size_t joint : joints)
    text += (text.empty() ? "" : ", ") + std::to_string(joint + 1);
  return text;
}

Order without_none(Order joints) {
  std::erase(joints, kNoJoint);
  return joints;
}

/// Those of `joints` that `others` has too.
Order common(Order joints, const Order& others) {
  std::erase_if(joints, [&](std::size_t joint) {
    return std::find(others.begin(), others.end(), joint) == others.end();
  });
  return joints;
}

class Assigner {
 public:
  Assigner(std::vector<Sweep>& strokes, const Campaign& campaign)
      : strokes_(strokes), campaign_(campaign), plan_(campaign) {}

  JointAssignment run() {
    const BodyTurns body(strokes_, plan_.order().size());
    for (const auto& turns : body.to_tell()) tell_joints(turns);
    body.spread(strokes_);
    return std::move(found_);
  }

 private:
  void tell_joints(const std::vector<Turn>& turns) {
    turns_ = turns;
    part();
    if (turns_.size() < plan_.order().size()) {
      if (const auto moves = moves_on_no_circle(strokes_)) warn("moves_on_no_circle", *moves);
      mismatch();
    }
    if (turns_.empty()) return;
    decide();
    const Order& joints = chosen_.joints;
    if (before_ && common(joints, *before_) != common(*before_, joints))
      doubt("the targets do not tell the same order of joints: " + names(*before_) + " and " +
                names(joints),
            "order_ambiguous");
    before_ = joints;
    apply();
  }

  void warn(const std::string& code, const std::string& message) {
    for (const Warning& known : found_.warnings)
      if (known.code == code) return;  // another target says the same
    found_.warnings.push_back({code, {}, message});
  }

  void doubt(const std::string& why, const std::string& code) {
    if (!found_.doubt.empty()) return;
    found_.doubt = why;
    std::string missing = plan_.given() ? "" : "the sweep plan that was run";
    if (!campaign_.specified)
      missing += std::string(missing.empty() ? "" : " and ") + "the robot description";
    warn(code, why + ": send joint angles (AIPos), " +
                   (missing.empty() ? "" : "give " + missing + ", ") +
                   "or name the joint of each point");
  }

  /// Parts turns of joints that have one axis at home, where the plan tells, and the description
  /// has such joints. Without one all strokes of the plan have to be seen, and in its order.
  void part() {
    while (turns_.size() < plan_.order().size()) {
      const auto before = turns_;
      const auto partings = plan_.partings(before);
      if (std::none_of(partings.begin(), partings.end(), [&](const auto& parting) {
            turns_ = parting.of(before);
            if (campaign_.specified) return fit_at_home(turns_, campaign_);
            return parting.whole &&
                   (turns_.size() < plan_.order().size() || plan_.explains_in_order(turns_));
          })) {
        turns_ = before;
        return;
      }
    }
  }

  void mismatch() {
    const std::string more = turns_.size() < 2 * plan_.order().size() ? "" : " or more";
    const bool linear =
        campaign_.specified && turning_joints(*campaign_.specified) < campaign_.joints;
    const std::string declared =
        std::to_string(plan_.order().size()) + (linear ? " joints that turn: " : " joints: ");
    const std::string remedy = plan_.given()
                                   ? "plan has " + declared +
                                         "check that it is the one that was run, and that "
                                         "each joint moved alone"
                                   : "arm has " + declared +
                                         "give the sweep plan that was run, or send joint "
                                         "angles (AIPos)";
    warn("order_mismatch", std::to_string(turns_.size()) + more +
                               " axes were swept one after the other, but the " + remedy);
  }

  void decide() {
    std::vector<JointOrder> fitting = fits();
    if (fitting.empty() && turns_.size() > plan_.order().size()) {
      mismatch();
      tell_left_out(turns_.size() - plan_.order().size());
      keep(plan_.joints_of(turns_));
      if (undecided_) fitting = fits();
    }
    if (fitting.empty()) {
      assume();
      return;
    }
    // Geometry first; the plan chooses among what that leaves.
    const auto by_plan = [&](const JointOrder& order) { return plan_.misfit(turns_, order); };
    const auto best = std::min_element(
        fitting.begin(), fitting.end(),
        [&](const JointOrder& a, const JointOrder& b) { return by_plan(a) < by_plan(b); });
    chosen_ = *best;
    tell_left_out(turns_.size() - without_none(best->joints).size());
    senses_found_ = std::none_of(fitting.begin(), fitting.end(), [&](const JointOrder& order) {
      return order.joints == best->joints && order.senses != best->senses;
    });
    const auto is_declared = [&](const JointOrder& order) {
      const Order joints = without_none(order.joints);
      return joints == (plan_.given() ? common(plan_.order(), joints) : declared());
    };
    std::optional<JointOrder> rival;
    for (const JointOrder& order : fitting)
      if (order.joints != best->joints && by_plan(order) < by_plan(*best) + kByChance &&
          (!rival || (is_declared(order) && !is_declared(*rival))))
        rival = order;
    if (rival) {
      if (is_declared(*rival) && !is_declared(chosen_)) std::swap(*rival, chosen_);
      tell(*rival);
    } else if (!is_declared(chosen_)) {
      warn(plan_.given() ? "order_differs" : "order_found",
           "the joints swept in the order " + names(without_none(chosen_.joints)) +
               ", as the robot description tells" +
               (plan_.given() ? ", and not in that of the plan: check that the plan is the one "
                                "that was run"
                              : ""));
    }
    keep(chosen_.joints);
    check_plan();
  }

  /// That another order than the chosen one agrees with the description, too.
  void tell(const JointOrder& rival) {
    const Order one = without_none(chosen_.joints), other = without_none(rival.joints);
    const std::string both = "the joints may have swept in the order " + names(one) + " or " +
                             names(other) + ", both agree with the robot description; ";
    const bool senses_found = std::exchange(senses_found_, false);
    if (one == other)
      return doubt("more than one move on a circle may be the sweep of one joint",
                   "order_ambiguous");
    if (plan_.given() && one == declared() && turns_.size() >= plan_.order().size() &&
        plan_.explains(turns_, chosen_))
      return doubt(both + "the plan's is taken, which explains all sweeps", "order_ambiguous");
    // Where they do not tell the same joints, one may be in the turn of the other, or both.
    bool left = false, same_senses = true;
    for (std::size_t t = 0; t < turns_.size(); ++t) {
      const std::size_t a = chosen_.joints[t], b = rival.joints[t];
      if (a == kNoJoint || b == kNoJoint) continue;
      if (a == b) {
        same_senses = same_senses && chosen_.senses[t] == rival.senses[t];
      } else if (common({a}, other).empty() && common({b}, one).empty()) {
        doubt("one sweep may be of joint " + names({a}) + ", of joint " + names({b}) +
                  " or of both, and is left out; where both have one axis at home, let another "
                  "joint sweep between them",
              "order_ambiguous");
        chosen_.joints[t] = kNoJoint;
        left = true;
      }
    }
    if (left)
      senses_found_ = senses_found && same_senses;
    else
      doubt(both + "the first is taken", "order_ambiguous");
  }

  /// Orders that agree with the description. The plan may lack a joint that swept, and the arm one
  /// that did not.
  std::vector<JointOrder> fits() {
    undecided_ = false;
    if (!campaign_.specified) return {};
    const std::size_t most = std::min(turns_.size(), turning_joints(*campaign_.specified));
    const std::size_t least = std::min(most, plan_.given() ? plan_.order().size() : most);
    FittingOrders orders = fitting_orders(turns_, least, most, campaign_);
    undecided_ = orders.undecided;
    if (orders.elsewhere) {
      found_.home_holds = false;
      warn("home_contradicted",
           "the arm did not stand at the plan's home: its angles at home are taken as unknown; "
           "check that the plan is the one that was run");
    }
    return std::move(orders.fitting);
  }

  /// The declared order, as far as it goes.
  [[nodiscard]] Order declared() const {
    const std::size_t count = std::min(turns_.size(), plan_.order().size());
    return {plan_.order().begin(), plan_.order().begin() + static_cast<std::ptrdiff_t>(count)};
  }

  /// Leaves out the turns that are no joint's.
  void keep(const Order& joints) {
    std::vector<Turn> kept;
    JointOrder chosen;
    for (std::size_t t = 0; t < turns_.size(); ++t) {
      if (joints[t] == kNoJoint) continue;
      kept.push_back(std::move(turns_[t]));
      if (chosen_.joints.size() != turns_.size()) continue;
      chosen.joints.push_back(chosen_.joints[t]);
      chosen.senses.push_back(chosen_.senses[t]);
    }
    turns_ = std::move(kept);
    chosen_ = std::move(chosen);
  }

  void tell_left_out(std::size_t count) {
    if (count == 0) return;
    warn("moves_left_out", std::to_string(count) +
                               (count == 1 ? " move on a circle was" : " moves on circles were") +
                               " left out as no joint's sweeps: several joints may have moved at "
                               "once");
  }

  void assume() {
    chosen_ = {declared(), std::vector<int>(turns_.size(), 1), 0};
    senses_found_ = false;
    for (std::size_t t = 0; t < turns_.size(); ++t) {
      const std::size_t joint = chosen_.joints[t];
      if (plan_.misfit(turns_[t], joint, -1) < plan_.misfit(turns_[t], joint, 1))
        chosen_.senses[t] = -1;
    }
    const std::string order = plan_.given() ? "the plan's order of joints, " + names(chosen_.joints)
                                            : "the order of joints, " + names(chosen_.joints);
    doubt(order + ", is assumed: " +
              (undecided_            ? "the arcs are too poor to compare with the robot description"
               : campaign_.specified ? "no order agrees with the robot description"
                                     : "no robot description confirms it"),
          "order_assumed");
    check_plan();
  }

  /// Which joints the plan does not explain; the sense of those is not known. Where it would
  /// explain the opposite, plan and description tell two robots.
  void check_plan() {
    Order against;
    for (std::size_t t = 0; t < turns_.size(); ++t) {
      const std::size_t joint = chosen_.joints[t];
      if (!plan_.tells_sense(joint))
        found_.senses_known = found_.senses_known && senses_found_;
      else if (!plan_.explains(turns_[t], joint, chosen_.senses[t]))
        (plan_.tells(turns_[t], joint, -chosen_.senses[t]) ? found_.against_plan : against)
            .push_back(joint);
    }
    if (against.empty() && found_.against_plan.empty()) return;
    found_.senses_known = found_.senses_known && senses_found_;
    if (against.empty()) return;
    std::sort(against.begin(), against.end());
    warn("plan_contradicted", "the sweeps of joint" + std::string(against.size() > 1 ? "s " : " ") +
                                  names(against) +
                                  " are not those of the plan, by their angles or their number: "
                                  "check that the plan is the one that was run");
  }

  void apply() {
    for (std::size_t t = 0; t < turns_.size(); ++t) {
      // Where nothing tells, the first stroke is the way that counts as positive.
      const double sense =
          found_.senses_known ? chosen_.senses[t] : turns_[t].strokes.front().angle_rad;
      for (const Turn::Stroke& seen : turns_[t].strokes) {
        Sweep& stroke = strokes_[seen.place];
        stroke.joint = chosen_.joints[t];
        stroke.direction = sense * seen.angle_rad < 0 ? -1 : 1;
      }
    }
  }

  std::vector<Sweep>& strokes_;
  const Campaign& campaign_;
  PlannedTurns plan_;
  std::vector<Turn> turns_;
  JointOrder chosen_;
  std::optional<Order> before_;  // of the target before
  bool senses_found_ = false;    // by the geometry alone
  bool undecided_ = false;       // so many orders agree in part
  JointAssignment found_;
};

}  // namespace

JointAssignment assign_joints(std::vector<Sweep>& strokes, const Campaign& campaign) {
  return Assigner(strokes, campaign).run();
}

}  // namespace identify
