function [status, said] = run_python(python, order)
% Run a Python interpreter; what it says on both channels is one text.
    command = [quoted(python) ' ' order ' 2>&1'];
    if isunix
        % MATLAB sets a path to libraries of its own, older than those of the system.
        command = ['env -u LD_LIBRARY_PATH ' command];
    end
    [status, said] = system(command);
end
