function values = simulate(block, times, rows)
% Run a block from its set-up to its end, as Simulink does; one output for each row.
    values = zeros(size(rows, 1), 1);
    end_it = onCleanup(@() block.call('Terminate'));
    block.prepare(size(rows, 2), times(2) - times(1));
    for i = 1:size(rows, 1)
        values(i) = block.step(times(i), rows(i, :));
    end
end
