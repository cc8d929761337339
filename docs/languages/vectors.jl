# Compares a function with a file of test vectors. To run it:
#
#     graphdyn vectors ur5 --out vectors
#     julia vectors.jl     (librnea.so: see rnea.c)

"Count the rows with a number beyond its tolerance."
function failures(path, arguments, f)
    failed = 0
    for line in Iterators.drop(eachline(path), 1)
        row = parse.(Float64, split(line, ','))
        numbers = (length(row) - arguments) ÷ 2
        answer = f(row[1:arguments])  # for a matrix M: vec(permutedims(M)), because Julia stores columns first
        expected, tolerances = row[arguments+1:arguments+numbers], row[arguments+numbers+1:end]
        failed += !all(abs.(answer .- expected) .<= tolerances)  # NaN is wrong
    end
    return failed
end

function rnea(x)
    tau = zeros(6)
    q, v, a = x[1:6], x[7:12], x[13:18]
    ccall((:rnea, "./librnea.so"), Cint, (Cint, Ptr{Cdouble}, Ptr{Cdouble}, Ptr{Cdouble}, Ptr{Cdouble}), 6, q, v, a, tau)
    return tau
end

failed = failures("vectors/inverse_dynamics.csv", 18, rnea)
println("inverse_dynamics: $failed rows fail")
exit(failed != 0)
