function text = quoted(text)
% Quote a word for the shell.
    if isunix
        text = ['''' strrep(text, '''', '''\''''') ''''];
    else
        text = ['"' text '"'];
    end
end
