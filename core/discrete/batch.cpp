#include "batch.hpp"

#include "../values/lanes.hpp"
#include "../values/truth.hpp"
#include "lane_rows.hpp"
#include "plan_runner.hpp"
#include "truth_memory.hpp"
#include "truth_tiles.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>

namespace rtamt::discrete {

namespace {

constexpr std::size_t lanes = 8;
using Lane = Lanes<lanes>;

// The rows of eight traces; the last one stands for those that are missing.
template <class Row, class Get>
[[nodiscard]] LaneRows<Row, lanes> lane_rows(std::size_t first, std::size_t traces, Get&& get) {
    LaneRows<Row, lanes> rows{};
    for (std::size_t lane = 0; lane < lanes; ++lane)
        rows[lane] = get(first + std::min(lane, traces - 1));
    return rows;
}

// The variables of eight traces at a time.
class LaneColumns {
  public:
    void fill(const BatchRows& batch, std::size_t first, std::size_t traces) {
        columns_.resize(batch.columns.size());
        pointers_.clear();
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            columns_[i].resize(batch.count);
            const auto rows = lane_rows<const double>(
                first, traces, [&](std::size_t trace) { return batch.samples(i, trace); });
            gather<lanes>(rows, batch.count, columns_[i].data());
            pointers_.push_back(columns_[i].data());
        }
    }

    [[nodiscard]] std::span<const Lane::Value* const> columns() const noexcept { return pointers_; }

  private:
    std::vector<std::vector<Lane::Value>> columns_;
    std::vector<const Lane::Value*> pointers_;
};

// A trace after the other.
class Singles {
  public:
    explicit Singles(std::span<const Stage> stages) : runner_(stages) {}

    [[nodiscard]] bool run(const BatchRows& batch, std::size_t trace) {
        columns_.clear();
        for (std::size_t i = 0; i < batch.columns.size(); ++i)
            columns_.push_back(batch.samples(i, trace));
        double* result = batch.result(trace);
        const double* values = runner_.run(columns_, batch.count, result);
        if (values == nullptr) return false;
        if (values != result) copy_values(values, batch.count, result);
        return true;
    }

    void release() noexcept { runner_.release(); }

  private:
    PlanRunner<Real> runner_;
    std::vector<const double*> columns_;
};

// Eight traces at a time.
class Eights {
  public:
    explicit Eights(std::span<const Stage> stages) : runner_(stages) {}

    [[nodiscard]] bool run(const BatchRows& batch, std::size_t first, std::size_t traces) {
        columns_.fill(batch, first, traces);
        results_.resize(batch.count);
        const Lane::Value* values = runner_.run(columns_.columns(), batch.count, results_.data());
        if (values == nullptr) return false;
        scatter<lanes>(values, batch.count,
                       lane_rows<double>(first, traces,
                                         [&](std::size_t trace) { return batch.result(trace); }));
        return true;
    }

    void release() noexcept {
        runner_.release();
        columns_ = {};
        results_ = {};
    }

  private:
    PlanRunner<Lane> runner_;
    LaneColumns columns_;
    std::vector<Lane::Value> results_;
};

// The predicates of up to 64 traces, as words.
class Predicates {
  public:
    explicit Predicates(const TruthPlan& plan)
        : pointwise_(plan.pointwise), words_(plan.numbers.outputs.size()) {
        if (pointwise_) {
            flat_.emplace(plan.numbers);
        } else {
            lanes_.emplace(plan.numbers);
        }
    }

    // Nothing where a value is undefined; else a column of words for each predicate.
    [[nodiscard]] std::optional<std::span<const void* const>>
    pack(const BatchRows& batch, std::size_t first, std::size_t traces) {
        columns_.clear();
        for (auto& words : words_) {
            words.resize(TruthBits::words(batch.count) * truth_word_bits);
            columns_.push_back(words.data());
        }
        const bool defined =
            pointwise_ ? pack_flat(batch, first, traces) : pack_lanes(batch, first, traces);
        if (!defined) return std::nullopt;
        return columns_;
    }

    void release() noexcept {
        for (auto& words : words_)
            words = {};
        numbers_.clear();
        truths_.clear();
        lane_columns_ = {};
        lane_truths_.clear();
    }

  private:
    // So many samples are evaluated before they are packed: some traces, or a part of one.
    static constexpr std::size_t piece = 4096;

    bool pointwise_;
    std::optional<Executor> flat_;
    std::optional<BasicExecutor<Lane>> lanes_;
    std::vector<std::vector<TruthWord>> words_;
    std::vector<const void*> columns_;
    std::vector<std::vector<double>> numbers_; // of some traces, where they are not consecutive
    std::vector<std::vector<double>> truths_;
    LaneColumns lane_columns_;
    std::vector<std::vector<Lane::Value>> lane_truths_;

    [[nodiscard]] bool pack_flat(const BatchRows& batch, std::size_t first, std::size_t traces) {
        const std::size_t together = std::max<std::size_t>(piece / batch.count, 1);
        const std::size_t longest = std::min(together * batch.count, piece);
        numbers_.resize(batch.columns.size());
        truths_.resize(words_.size());
        std::vector<const double*> inputs(numbers_.size());
        std::vector<double*> outputs;
        for (auto& truths : truths_) {
            truths.resize(std::max(truths.size(), longest));
            outputs.push_back(truths.data());
        }
        for (std::size_t row = 0; row < traces; row += together) {
            const std::size_t rows = std::min(together, traces - row);
            for (std::size_t begin = 0; begin < batch.count; begin += longest) {
                const std::size_t size = std::min(longest, batch.count - begin);
                for (std::size_t i = 0; i < inputs.size(); ++i)
                    inputs[i] = consecutive(batch, i, first + row, rows) + begin;
                if (flat_->evaluate(inputs, rows * size, outputs)) return false;
                for (std::size_t i = 0; i < words_.size(); ++i) {
                    for (std::size_t k = 0; k < rows; ++k)
                        pack(outputs[i] + k * size, size, words_[i].data() + begin + row + k);
                }
            }
        }
        for (auto& words : words_)
            transpose_tiles(words.data(), TruthBits::words(batch.count));
        return true;
    }

    // The samples of a trace to one word of each tile.
    static void pack(const double* truths, std::size_t count, TruthWord* words) noexcept {
        for (std::size_t i = 0; i < count; i += truth_word_bits)
            words[i] = pack_truth(truths + i, std::min(truth_word_bits, count - i));
    }

    // The samples of some traces one after another.
    [[nodiscard]] const double* consecutive(const BatchRows& batch, std::size_t column,
                                            std::size_t first, std::size_t traces) {
        const double* samples = batch.samples(column, first);
        if (batch.samples(column, first + traces - 1) == samples + (traces - 1) * batch.count) {
            return samples;
        }
        std::vector<double>& numbers = numbers_[column];
        numbers.resize(std::max(numbers.size(), traces * batch.count));
        for (std::size_t k = 0; k < traces; ++k)
            std::copy_n(batch.samples(column, first + k), batch.count,
                        numbers.data() + k * batch.count);
        return numbers.data();
    }

    [[nodiscard]] bool pack_lanes(const BatchRows& batch, std::size_t first, std::size_t traces) {
        lane_truths_.resize(words_.size());
        std::vector<Lane::Value*> outputs;
        for (auto& truths : lane_truths_) {
            truths.resize(batch.count);
            outputs.push_back(truths.data());
        }
        for (std::size_t row = 0; row < traces; row += lanes) {
            lane_columns_.fill(batch, first + row, std::min(lanes, traces - row));
            if (lanes_->evaluate(lane_columns_.columns(), batch.count, outputs)) return false;
            for (std::size_t i = 0; i < words_.size(); ++i) {
                TruthWord* words = words_[i].data();
                if (row == 0) std::fill_n(words, batch.count, 0);
                for (std::size_t k = 0; k < batch.count; ++k)
                    words[k] |= pack_truth(outputs[i][k].lane.data(), lanes) << row;
            }
        }
        return true;
    }
};

// 64 traces at a time, whose values are truth values.
class Words {
  public:
    explicit Words(const TruthPlan& plan) : predicates_(plan), runner_(plan.joined) {}

    [[nodiscard]] bool run(const BatchRows& batch, std::size_t first, std::size_t traces) {
        const auto columns = predicates_.pack(batch, first, traces);
        if (!columns) return false;
        const std::size_t tiles = TruthBits::words(batch.count);
        results_.resize(tiles * truth_word_bits);
        const TruthWord* values = runner_.run(*columns, batch.count, results_.data());
        if (values != results_.data()) std::copy_n(values, batch.count, results_.data());
        transpose_tiles(results_.data(), tiles);
        for (std::size_t k = 0; k < traces; ++k) {
            double* result = batch.result(first + k);
            for (std::size_t i = 0; i < batch.count; i += truth_word_bits) {
                unpack_truth(results_[i + k], std::min(truth_word_bits, batch.count - i),
                             result + i);
            }
        }
        return true;
    }

    void release() noexcept {
        predicates_.release();
        runner_.release();
        results_ = {};
    }

  private:
    Predicates predicates_;
    PlanRunner<Truth> runner_;
    std::vector<TruthWord> results_;
};

// The stages, if each reads what is there.
[[nodiscard]] std::vector<Stage> checked(std::vector<Stage> stages, std::size_t variables) {
    std::size_t columns = variables;
    for (const Stage& stage : stages) {
        const std::size_t outputs = stage.program.outputs.size();
        const bool right =
            stage.columns.size() == stage.program.inputs &&
            std::ranges::all_of(stage.columns, [&](auto place) { return place < columns; }) &&
            std::ranges::all_of(stage.scans, [&](const Scan& scan) {
                return scan.a < outputs && scan.b < outputs;
            });
        if (!right) throw std::invalid_argument("A program of a plan reads what is not there.");
        columns += stage.scans.size();
    }
    if (stages.empty() || stages.back().program.outputs.size() != 1) {
        throw std::invalid_argument("The last program of a plan has one output.");
    }
    return stages;
}

} // namespace

// What runs a batch in one thread.
class Batch::Worker {
  public:
    explicit Worker(const Batch& batch) : batch_(batch) {}

    [[nodiscard]] bool run(const BatchRows& rows) {
        // Fewer traces cost less one by one, or in lanes.
        constexpr std::size_t worth_lanes = 3;
        constexpr std::size_t worth_words = 8;
        for (std::size_t first = 0; first < rows.rows.size();) {
            const std::size_t left = rows.rows.size() - first;
            std::size_t traces = 1;
            bool defined = true;
            if (batch_.truth_ && left >= worth_words) {
                traces = std::min(left, Truth::traces);
                if (!words_) words_.emplace(*batch_.truth_);
                defined = words_->run(rows, first, traces);
            } else if (left >= worth_lanes) {
                traces = std::min(left, lanes);
                if (!eights_) eights_.emplace(batch_.stages_);
                defined = eights_->run(rows, first, traces);
            } else {
                if (!singles_) singles_.emplace(batch_.stages_);
                defined = singles_->run(rows, first);
            }
            if (!defined) return false;
            first += traces;
        }
        return true;
    }

    void release() noexcept {
        if (singles_) singles_->release();
        if (eights_) eights_->release();
        if (words_) words_->release();
    }

  private:
    const Batch& batch_;
    std::optional<Singles> singles_;
    std::optional<Eights> eights_;
    std::optional<Words> words_;
};

Batch::Batch(std::vector<Stage> stages, std::size_t variables)
    : stages_(checked(std::move(stages), variables)), variables_(variables),
      truth_(truth_plan(stages_, variables)) {}

Batch::~Batch() {
    delete spare_.load();
}

bool Batch::evaluate(const BatchRows& rows) {
    std::unique_ptr<Worker> worker(spare_.exchange(nullptr));
    if (!worker) worker = std::make_unique<Worker>(*this);
    if (!worker->run(rows)) return false;
    worker->release();
    worker.reset(spare_.exchange(worker.release()));
    return true;
}

} // namespace rtamt::discrete
