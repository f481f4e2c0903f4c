#include "results/ledger_csv.hpp"

namespace carom::tool {

LedgerCsv::LedgerCsv(const std::filesystem::path& path) : file_(path) {
    file_.write(
        "time,kinetic,rotational,potential,total,px,py,L,"
        "gravity,drag,restitution,friction,correction,joints,drive,unexplained,"
        "px_gravity,py_gravity,px_drag,py_drag,px_walls,py_walls,px_immovable,py_immovable,"
        "px_unexplained,py_unexplained,wall_impulse,impacts,sleep,px_sleep,py_sleep,outside,px_outside,py_"
        "outside\n");
}

void LedgerCsv::append(const Ledger& ledger, std::int64_t impacts) {
    const Energy& energy = ledger.energy;
    const EnergyByCause& work = ledger.energy_by_cause;
    const MomentumByCause& given = ledger.momentum_by_cause;
    line_.clear();
    for (const double value :
         {ledger.time,         energy.kinetic,      energy.rotational,  energy.potential,
          energy.total(),      ledger.momentum.x,   ledger.momentum.y,  ledger.angular_momentum,
          work.gravity,        work.drag,           work.restitution,   work.friction,
          work.correction,     work.joints,         work.drive,         work.unexplained,
          given.gravity.x,     given.gravity.y,     given.drag.x,       given.drag.y,
          given.walls.x,       given.walls.y,       given.immovable.x,  given.immovable.y,
          given.unexplained.x, given.unexplained.y, ledger.wall_impulse}) {
        append_number(line_, value);
        line_ += ',';
    }
    line_ += std::to_string(impacts);
    for (const double value :
         {work.sleep, given.sleep.x, given.sleep.y, work.outside, given.outside.x, given.outside.y}) {
        line_ += ',';
        append_number(line_, value);
    }
    line_ += '\n';
    file_.write(line_);
}

}  // namespace carom::tool
