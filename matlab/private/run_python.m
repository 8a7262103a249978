function [status, said] = run_python(python, order)
% Run a Python interpreter and return its stdout and stderr as one text.
    command = [quoted(python) ' ' order ' 2>&1'];
    if isunix
        % MATLAB sets a path to its libraries, which are older than the system's.
        command = ['env -u LD_LIBRARY_PATH ' command];
    end
    [status, said] = system(command);
end
