function install_rtamt(python)
%INSTALL_RTAMT Build the gateway of online_monitor and add it to the path.
%
%   INSTALL_RTAMT uses the interpreter python3 (on Windows, python), in which
%   rtamt must be installed: 'pip install FOLDER', where FOLDER is the one that
%   contains this folder. INSTALL_RTAMT(PYTHON) uses another interpreter, such
%   as '/home/me/.venv/bin/python'.
%
%   It copies the C library from that installation, builds the MEX gateway to it
%   (this needs a C compiler: 'mex -setup' in MATLAB) and stores the interpreter,
%   which compiles specifications given as text. Simulations do not use Python.
%   Run it again after an update of rtamt or a move of this folder.

    if nargin < 1
        python = default_python();
    end
    here = fileparts(mfilename('fullpath'));
    inside = fullfile(here, 'private');
    [python, library, header] = locate(python);
    build(inside, library, header);
    write_text(fullfile(inside, 'python.txt'), python);
    addpath(here);
    rehash;
    try_out();
    fprintf('rtamt is ready. For the next session, put this into startup.m:\n');
    fprintf('addpath(''%s'');\n', here);
end

function python = default_python()
    python = 'python3';
    if ispc
        python = 'python';
    end
end

function [python, library, header] = locate(python)
% Return the full path of the interpreter, the C library and its header.
    question = ['import sys, rtamt.c_api as r; ' ...
                'print(sys.executable, r.library(), r.header(), sep=chr(10))'];
    [status, said] = run_python(python, ['-c "' question '"']);
    lines = strsplit(strtrim(said), sprintf('\n'));
    if status ~= 0
        root = fileparts(fileparts(mfilename('fullpath')));
        error('rtamt:notInstalled', ['rtamt is not installed in the Python ''%s'': run ' ...
              '''pip install "%s"'' there, or name another one: install_rtamt(''...''). ' ...
              'It said: %s'], python, root, strtrim(lines{end}));
    end
    lines = strtrim(lines);
    [python, library, header] = deal(lines{end - 2:end});
end

function build(folder, library, header)
% Copy the library next to the gateway, which links to it by its full path.
    clear rtamt_gateway;
    [~, name, ending] = fileparts(library);
    copied = fullfile(folder, [name ending]);
    if isfile(copied)
        delete(copied); % it may be loaded; the old file stays intact
    end
    [done, reason] = copyfile(library, copied);
    if ~done
        error('rtamt:notInstalled', 'The library cannot be copied to %s: %s', copied, reason);
    end
    back = cd(folder);
    return_there = onCleanup(@() cd(back));
    if exist('OCTAVE_VERSION', 'builtin')
        copied = ['-Wl,' copied]; % its mex takes no library by name
    end
    mex(['-I' fileparts(header)], 'rtamt_gateway.c', copied);
end

function write_text(name, text)
    file = fopen(name, 'w');
    if file < 0
        error('rtamt:notInstalled', 'The file ''%s'' cannot be written.', name);
    end
    fprintf(file, '%s\n', text);
    fclose(file);
end

function try_out()
% Evaluate a requirement with a known result: the margin of 5 to 3 is 2.
    robustness = rtamt_robustness('x >= 3', 'x', 1, 5);
    if robustness ~= 2
        error('rtamt:notInstalled', 'The gateway was built, but ''x >= 3'' is %g at 5.', ...
              robustness);
    end
end
