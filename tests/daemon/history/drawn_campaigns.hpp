#pragma once

// Campaigns as they would come out again and again: the noise of each is drawn from the covariance
// of one that was identified.

#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>

#include "daemon/history/campaign_record.hpp"

namespace sweepd::test {

class DrawnCampaigns {
 public:
  /// Of a result.json.
  explicit DrawnCampaigns(const std::string& result) {
    CampaignTexts texts;
    texts.name = "drawn";
    texts.result = result;
    record_ = campaign_record(texts);
    if (!record_.arm) throw std::runtime_error(record_.why_not);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solved(record_.arm->arm.covariance);
    root_ = solved.eigenvectors() * solved.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  }

  [[nodiscard]] const CampaignRecord& record() const { return record_; }
  [[nodiscard]] std::vector<identify::DhRow> rows() const { return values(record_.arm->arm.dh); }

  /// One whose arm truly has `rows`.
  [[nodiscard]] CampaignRecord draw(const std::vector<identify::DhRow>& rows,
                                    std::mt19937& random) const {
    CampaignRecord record = record_;
    std::normal_distribution<> normal;
    Eigen::VectorXd noise(root_.cols());
    for (double& value : noise) value = normal(random);
    noise = root_ * noise;
    Eigen::Index at = 0;
    for (std::size_t j = 0; j < rows.size(); ++j) {
      identify::DhEstimate& row = record.arm->arm.dh[j];
      row.b_mm.value = rows[j].b_mm + noise(at++);
      row.theta_rad.value = rows[j].theta_rad + noise(at++);
      row.a_mm.value = rows[j].a_mm + noise(at++);
      row.alpha_rad.value = rows[j].alpha_rad + noise(at++);
      row.beta_rad.value = rows[j].beta_rad + noise(at++);
    }
    return record;
  }

 private:
  CampaignRecord record_;
  Eigen::MatrixXd root_;
};

}  // namespace sweepd::test
