function values = simulate_roughly(block, times, rows)
% As simulate, with a solver of variable step and an algebraic loop: wrong inputs come
% before and after the right one, in iterations of the loop, and in minor steps.
    values = zeros(size(rows, 1), 1);
    end_it = onCleanup(@() block.call('Terminate'));
    block.prepare(size(rows, 2), times(2) - times(1));
    for i = 1:size(rows, 1)
        for trial = 1:mod(i, 3)
            block.output(times(i), rows(i, :) * (trial + 0.5) - trial);
        end
        values(i) = block.output(times(i), rows(i, :));
        if mod(i, 4) == 0
            block.output(times(i), rows(i, :) - 1);
        end
        block.update(times(i), rows(i, :));
        for part = [0.3, 0.35, 0.9]
            block.minor(times(i) + part * (times(2) - times(1)), rows(i, :) - 10 * part);
        end
    end
end
